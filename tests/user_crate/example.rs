pub(super) fn main() -> Result<(), Box<dyn std::error::Error>> {
use secateur::plant::{GrowOptions, Species};
use secateur::{Layout, LevelOptions, LevelsOptions, Plant, judge};

// Any .glb or .gltf will do: Plant::open(path). This one grows here.
let oak = Plant::grow(Species::Oak, &GrowOptions { leaves: 200, seed: 1 })?;

// What `secateur simplify --triangles 0.25` writes, material changes included.
let level = oak.level(&LevelOptions::triangles(0.25))?;
level.write("oak-25.glb")?;
let judged = judge(&oak, &Plant::open("oak-25.glb")?)?;
assert!(judged.difference_at(540.0).difference < 0.5);

// Levels for an engine, as `secateur lods` writes them.
oak.levels(&LevelsOptions::default())?.write("levels", Layout::Files)?;
Ok(())
}
