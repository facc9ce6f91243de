//! The fuzzer's seeds and thousands of fixed mutations of them: whatever the
//! text, reading, deriving and drawing end in a plant or in an error.

use std::path::Path;

use secateur_plant::{Random, Rules, draw};

/// What the fuzz target does with a file, too.
fn read(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let limited = format!("modules = 2000;\n{text}");
    let Ok(rules) = Rules::parse(&limited) else {
        let _ = Rules::parse(text);
        return;
    };
    if let Ok(word) = rules.derive(1.0, &mut Random::new(0)) {
        let _ = draw(&rules, &word);
    }
}

fn seeds() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/rule_parser");
    let entries = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read(path).unwrap())
        .collect()
}

#[test]
fn every_seed_ends_in_a_plant_or_an_error() {
    let seeds = seeds();
    assert!(seeds.len() >= 8, "{} seeds", seeds.len());
    let readable = |bytes: &&Vec<u8>| Rules::parse(std::str::from_utf8(bytes).unwrap()).is_ok();
    assert!(seeds.iter().filter(readable).count() >= 4);
    seeds.iter().for_each(|bytes| read(bytes));
}

#[test]
fn mutations_end_in_a_plant_or_an_error() {
    // Pieces that mean something, put anywhere.
    let pieces = [
        "(", ")", "[", "]", ";", "->", "<", ">", "^", "-", "if ", "weight ", "with ", "0", "1e9",
        "F(", ",", "axiom:", "let x = ", "#", "\u{e9}", " ",
    ];
    let mut random = Random::new(2026);
    let below = |random: &mut Random, end: usize| (random.bits() % end.max(1) as u64) as usize;
    for seed in seeds() {
        for _ in 0..300 {
            let mut bytes = seed.clone();
            for _ in 0..=below(&mut random, 4) {
                let at = below(&mut random, bytes.len());
                let end = (at + below(&mut random, 12)).min(bytes.len());
                match below(&mut random, 3) {
                    0 => drop(bytes.drain(at..end)),
                    1 => {
                        let piece = pieces[below(&mut random, pieces.len())];
                        bytes.splice(at..at, piece.bytes());
                    }
                    _ => {
                        let copy = bytes[at..end].to_vec();
                        let to = below(&mut random, bytes.len());
                        bytes.splice(to..to, copy);
                    }
                }
            }
            read(&bytes);
        }
    }
}
