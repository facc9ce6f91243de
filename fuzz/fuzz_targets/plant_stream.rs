//! Whatever the bytes, and whatever the bodies of its pieces, a stream ends in a plant that can be
//! drawn, or in an error; and it is the same plant however its bytes arrive.

#![no_main]

use libfuzzer_sys::fuzz_target;
use secateur_pages::stream::{StreamReader, read_stream, stream_of_bodies};

fuzz_target!(|bytes: &[u8]| {
    let _ = read_stream(bytes);
    // Each body behind its length; the last one may be cut.
    let mut bodies = Vec::new();
    let mut left = bytes;
    while let Some((length, rest)) = left.split_first_chunk::<4>() {
        let length = (u32::from_le_bytes(*length) as usize).min(rest.len());
        let (body, after) = rest.split_at(length);
        bodies.push(body);
        left = after;
    }
    let stream = stream_of_bodies(bodies);
    let at_once = read_stream(&stream);
    let mut reader = StreamReader::default();
    let mut arrived = Ok(0);
    for chunk in stream.chunks(stream.len() / 3 + 1) {
        arrived = reader.push(chunk);
        if arrived.is_err() {
            break;
        }
    }
    let Ok((plant, _)) = at_once else {
        assert!(arrived.is_err() || reader.plant().is_none());
        return;
    };
    let triangles: usize = plant
        .surfaces()
        .iter()
        .map(|(surface, _)| surface.triangles.len())
        .sum();
    assert_eq!(triangles as u64, plant.triangles()[0]);
    assert_eq!(reader.plant().map(|p| p.pieces()), Some(plant.pieces()));
});
