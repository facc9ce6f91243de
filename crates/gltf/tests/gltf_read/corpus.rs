//! The fuzzer's seeds and thousands of fixed mutations of them: whatever the
//! bytes, reading ends in a tree or in an error.

use std::path::Path;

use secateur_gltf::Document;

/// What the fuzz target does with a file, too.
fn read(bytes: &[u8]) {
    let Ok(document) = Document::from_bytes("fuzz.glb", bytes.to_vec(), None) else {
        return;
    };
    let _ = document.inspect(&[]).to_string();
    let _ = document.surfaces(&[]);
    let _ = document.into_tree(&["material:*".parse().unwrap()]);
}

/// Numbers that look random and are the same everywhere (xorshift64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

/// Flips bytes, changes digits, cuts or doubles a piece.
fn mutate(bytes: &mut Vec<u8>, numbers: &mut Numbers) {
    for _ in 0..=numbers.below(4) {
        if bytes.is_empty() {
            return;
        }
        let at = numbers.below(bytes.len());
        match numbers.below(8) {
            0..=2 => bytes[at] ^= 1 << numbers.below(8),
            3 => bytes[at] = numbers.next() as u8,
            4 | 5 => {
                // A digit of the JSON: most of its meaning is in numbers.
                let digits = bytes.iter().enumerate().filter(|(_, b)| b.is_ascii_digit());
                let digits: Vec<usize> = digits.map(|(at, _)| at).collect();
                if !digits.is_empty() {
                    let at = digits[numbers.below(digits.len())];
                    bytes[at] = b'0' + numbers.below(10) as u8;
                }
            }
            6 => bytes.truncate(at),
            _ => {
                let end = (at + numbers.below(16)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
}

fn seeds() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/gltf_loader");
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let file = |path: std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, std::fs::read(path).unwrap())
    };
    paths.into_iter().map(file).collect()
}

#[test]
fn seeds_are_small_and_read_as_their_names_say() {
    let seeds = seeds();
    assert!(seeds.len() >= 12, "{} seeds", seeds.len());
    for (name, bytes) in &seeds {
        assert!(bytes.len() < 4096, "{name}");
        let sound = Document::from_bytes(name, bytes.clone(), None)
            .and_then(|document| document.into_tree(&["material:*".parse().unwrap()]));
        assert_eq!(
            sound.is_err(),
            name.starts_with("broken"),
            "{name}: {sound:?}"
        );
    }
}

#[test]
fn no_mutation_of_a_seed_panics() {
    const MUTATIONS: usize = 300;
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    for (_, seed) in seeds() {
        read(&seed);
        for _ in 0..MUTATIONS {
            let mut bytes = seed.clone();
            mutate(&mut bytes, &mut numbers);
            read(&bytes);
        }
    }
}

/// The fuzzer starts from the very files that these tests make. When there is a
/// new encoding, run this with `SECATEUR_WRITE_SEEDS=1` to write them.
#[test]
fn the_fuzzers_seeds_are_these() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/gltf_loader");
    let writes = std::env::var_os("SECATEUR_WRITE_SEEDS").is_some();
    for (name, bytes) in crate::seeds::all() {
        let path = folder.join(name);
        if writes {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &bytes).unwrap();
        }
        let kept = std::fs::read(&path).unwrap_or_default();
        assert!(kept == bytes, "{} is not what is made now", path.display());
    }
}
