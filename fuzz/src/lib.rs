//! What the targets share: containers of glTF, and mutations that know its
//! structure. Bytes flipped at random seldom leave JSON that still parses.

mod container;
mod extremes;
mod json;

use secateur::{Document, Memory, Tree};
use secateur_plant::Random;

pub use container::{Container, glb};

/// The memory that a file may take: half of what a target may.
const MEMORY: Memory = Memory::Bytes(1 << 30);

/// The document in some bytes, read within a budget of memory.
pub fn document(bytes: &[u8]) -> Option<Document> {
    Document::from_bytes_within("fuzz.glb", bytes.to_vec(), None, MEMORY).ok()
}

/// The tree in some bytes, everything that looks like foliage taken.
pub fn tree(bytes: &[u8]) -> Option<Tree> {
    let document = document(bytes)?;
    let all = "material:*".parse().expect("a selector");
    document.into_tree(&[all]).ok()
}

/// Mutates a glTF of `size` bytes in place, as libFuzzer asks for it, and returns
/// its new size: its JSON by path, its BIN by word, or all of it by libFuzzer's
/// own means.
pub fn mutate_gltf(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    let mut random = Random::new(seed.into());
    let bytes_only = below(&mut random, 5) == 0;
    let mutated = match Container::parse(&data[..size]) {
        Some(mut container) if !bytes_only => {
            for _ in 0..=below(&mut random, 3) {
                if below(&mut random, 4) == 0 {
                    extremes::put_into(&mut container.bin, &mut random);
                } else {
                    json::mutate(&mut container.json, &mut random);
                }
            }
            container.to_bytes()
        }
        _ => return libfuzzer_sys::fuzzer_mutate(data, size, max_size),
    };
    if mutated.len() > max_size {
        return libfuzzer_sys::fuzzer_mutate(data, size, max_size);
    }
    data[..mutated.len()].copy_from_slice(&mutated);
    mutated.len()
}

/// A number from 0 up to `end`, which is not 0.
fn below(random: &mut Random, end: usize) -> usize {
    (random.bits() % end as u64) as usize
}

/// One of some things.
fn pick<'a, T>(random: &mut Random, from: &'a [T]) -> &'a T {
    &from[below(random, from.len())]
}
