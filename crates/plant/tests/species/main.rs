//! Every species, as other commands will find it in a file.

use secateur_gltf::{Document, Tree, plant_to_glb};
use secateur_plant::{GrowOptions, Species, grow};

fn grown(species: Species, leaves: u32, seed: u64) -> Vec<u8> {
    let plant = grow(species, &GrowOptions { leaves, seed });
    plant_to_glb(&plant.unwrap_or_else(|error| panic!("{species}: {error}")))
}

fn tree(glb: Vec<u8>) -> Tree {
    let document = Document::from_bytes("grown.glb", glb, None).unwrap();
    document.into_tree(&[]).unwrap()
}

#[test]
fn the_reader_finds_as_many_leaves_as_were_asked_for() {
    for &species in Species::ALL {
        for leaves in [1, 2, 37, 1000, species.default_leaves()] {
            let found = tree(grown(species, leaves, 11)).foliage().leaves().len();
            assert_eq!(found, leaves as usize, "{species}");
        }
    }
}

#[test]
fn equal_seeds_are_equal_and_others_are_siblings() {
    for &species in Species::ALL {
        let one = grown(species, 200, 1);
        assert_eq!(one, grown(species, 200, 1), "{species}");
        for seed in [0, 2, u64::MAX] {
            assert_ne!(one, grown(species, 200, seed), "{species}");
        }
    }
}

#[test]
fn all_leaves_together_keep_their_area_whatever_their_number() {
    let area = |species, leaves| -> f64 {
        let tree = tree(grown(species, leaves, 4));
        tree.foliage().leaves().iter().map(|leaf| leaf.area()).sum()
    };
    for &species in Species::ALL {
        let usual = species.default_leaves();
        let expected = area(species, usual);
        for leaves in [usual / 3, 2 * usual] {
            let share = area(species, leaves) / expected;
            assert!((share - 1.0).abs() < 0.08, "{species}, {leaves}: {share}");
        }
    }
}

#[test]
fn plants_stand_on_the_ground_and_every_leaf_has_an_area() {
    for &species in Species::ALL {
        let leaves = species.default_leaves();
        let plant = grow(species, &GrowOptions { leaves, seed: 5 }).unwrap();
        let lowest = plant.wood.positions.iter().map(|p| p.y);
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        assert!((-0.5..0.05).contains(&lowest), "{species}: {lowest} m");
        let tree = tree(plant_to_glb(&plant));
        let least = tree.foliage().leaves().iter().map(|leaf| leaf.area());
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(least > 1e-6, "{species}: {least} square metres");
    }
}

#[test]
fn rowan_leaves_have_18_triangles_and_needles_2() {
    let triangles = |species| {
        let plant = grow(
            species,
            &GrowOptions {
                leaves: 50,
                seed: 1,
            },
        );
        plant.unwrap().triangles_per_leaf[0]
    };
    assert_eq!(triangles(Species::Rowan), 18);
    assert_eq!(triangles(Species::Pine), 2);
    assert_eq!(triangles(Species::Oak), 2);
}
