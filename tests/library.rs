//! What the library writes, held against the files of the program.

use secateur::{LevelOptions, Opening, Plant, Target};

use crate::program::{Bench, shared_tree};

/// The bytes of a level as the library and as the program make them, and the library's warnings.
fn both(bench: &Bench, target: Target, arguments: &[&str]) -> [Vec<u8>; 2] {
    let simplify = ["simplify", "plant.glb", "-o", "of-program.glb"];
    bench.run(&[&simplify[..], arguments].concat()).succeeded();
    let opening = Opening {
        wood: LevelOptions::usual_wood(target),
        ..Opening::default()
    };
    let plant = Plant::open_with(bench.path("plant.glb"), &opening).unwrap();
    let level = plant.level(&LevelOptions::to(target)).unwrap();
    let file = bench.path("of-library.glb");
    let written = level.write(&file).unwrap();
    let bytes = bench.read("of-library.glb");
    assert_eq!(level.to_bytes().unwrap(), bytes);
    assert_eq!(written.bytes, bytes.len() as u64);
    assert!(level.difference.is_some());
    for name in ["of-library.glb", "of-program.glb"] {
        assert!(bench.names().iter().any(|there| there == name));
    }
    let of_program = bench.read("of-program.glb");
    for name in ["of-library.glb", "of-program.glb"] {
        std::fs::remove_file(bench.path(name)).unwrap();
    }
    [bytes, of_program]
}

#[test]
fn a_level_has_the_bytes_of_the_program() {
    let bench = Bench::new();
    bench.put("plant.glb", &bench.read("oak.glb"));
    let quarter = Target::leaf_share(0.25);
    for (target, arguments) in [
        (Target::triangle_share(0.1), ["--triangles", "0.1"]),
        (quarter, ["--ratio", "0.25"]),
    ] {
        let [ours, of_program] = both(&bench, target, &arguments);
        assert!(ours == of_program, "{arguments:?}");
    }
}

/// Its textures are cut out: cutoffs and colours change with the level.
#[test]
fn a_tenth_of_a_real_oak_has_the_bytes_of_the_program() {
    let Some(oak) = shared_tree("ez_oak_20k.glb") else {
        return;
    };
    let bench = Bench::new();
    bench.put("plant.glb", &std::fs::read(oak).unwrap());
    let [ours, of_program] = both(&bench, Target::triangle_share(0.1), &["--triangles", "0.1"]);
    assert!(ours == of_program);
}
