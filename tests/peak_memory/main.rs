//! What is held at once while levels of a grown plant are made, against the memory that is allowed.

mod counting;

use secateur::chain::{LevelsOptions, Wanted};
use secateur::plant::{GrowOptions, Species, grow};
use secateur::{
    Amount, Engine, Error, LevelOptions, Memory, Opening, OverMemory, Plant, plant_to_glb,
};

/// What the file, the plant and its levels are allowed to be over: the look at a level of `simplify` in small
/// pictures, and what is made for writing.
const BESIDE: usize = 32 << 20;

/// What is made of a plant.
type Made = fn(&Plant) -> Result<(), OverMemory>;

/// As much as is held at most, or what would take too much.
fn peak_within(memory: Memory, file: &[u8], make: Made) -> Result<usize, OverMemory> {
    let opening = Opening {
        memory,
        ..Opening::default()
    };
    let before = counting::held();
    counting::reset();
    let plant = Plant::from_bytes("oak.glb", file.to_vec(), &opening).expect("an oak");
    make(&plant)?;
    Ok(counting::peak_above(before))
}

fn one_level(plant: &Plant) -> Result<(), OverMemory> {
    let mut options = LevelOptions::triangles(0.1);
    options.simplify.engine = Engine::Cpu;
    options.simplify.audit = false;
    plant.level(&options).map(drop).map_err(of_memory)
}

fn of_memory(error: Error) -> OverMemory {
    let over = error.over_memory().cloned();
    over.unwrap_or_else(|| panic!("{error}"))
}

fn levels(plant: &Plant) -> Result<(), OverMemory> {
    let mut options = LevelsOptions {
        wanted: Wanted::Triangles(vec![Amount::Share(0.3), Amount::Share(0.1)]),
        ..LevelsOptions::default()
    };
    options.leaves.engine = Engine::Cpu;
    options.screen.height_px = 400.0;
    plant.levels(&options).map(drop).map_err(of_memory)
}

/// One test, so that nothing else is held meanwhile: a run that would pass its memory is refused, and in words before
/// the work.
#[test]
fn what_is_allowed_is_not_passed() {
    let options = GrowOptions {
        leaves: 3000,
        seed: 1,
    };
    let file = plant_to_glb(&grow(Species::Oak, &options).unwrap());
    for make in [one_level as Made, levels] {
        let peak = peak_within(Memory::Bytes(4 << 30), &file, make).unwrap();
        let less = Memory::Bytes((peak - BESIDE) as u64);
        let refused = peak_within(less, &file, make);
        let over = refused.expect_err("less memory than is held at most");
        assert!(over.bytes > over.left, "{over}");
        // Nor is what fits well refused.
        peak_within(Memory::Bytes(3 * peak as u64), &file, make).unwrap();
    }
}
