//! What is not the plant: ground and helpers.

use std::path::PathBuf;

use secateur_gltf::{Detail, Document, Selector, TakenFor};
use serde_json::{Value, json};

use crate::small_tree::SmallTree;

/// A file of nodes, each with a mesh of its own.
struct Garden {
    file: SmallTree,
}

impl Garden {
    fn new() -> Self {
        let mut file = SmallTree::empty();
        for list in ["nodes", "meshes"] {
            file.root[list] = json!([]);
        }
        file.root["scenes"] = json!([{"nodes": []}]);
        file.root["materials"] = json!([{"name": "leaf"}, {"name": "bark"}, {"name": "stone"}]);
        Self { file }
    }

    /// With a node at the root that draws these triangles.
    fn with(mut self, name: &str, material: usize, corners: &[[f32; 3]]) -> Self {
        let positions = self.file.floats("VEC3", corners.as_flattened());
        let primitive = json!({"attributes": {"POSITION": positions}, "material": material});
        let mesh = self
            .file
            .append("meshes", json!({"primitives": [primitive]}));
        let node = self
            .file
            .append("nodes", json!({"name": name, "mesh": mesh}));
        let roots = self.file.root["scenes"][0]["nodes"].as_array_mut().unwrap();
        roots.push(node.into());
        self
    }

    /// With a stem 4 high and 20 leaves about it, 2 wide.
    fn with_tree(self) -> Self {
        let leaf = |k: usize| {
            let angle = k as f32;
            let (x, z, y) = (angle.cos(), angle.sin(), 2.0 + 0.1 * k as f32);
            [[x, y, z], [x + 0.1, y, z], [x, y + 0.1, z]]
        };
        let leaves: Vec<[f32; 3]> = (0..20).flat_map(leaf).collect();
        let stem = [[-0.1, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 4.0, 0.0]];
        self.with("Stem", 1, &stem).with("Leaves", 0, &leaves)
    }

    /// What each node is taken for.
    fn taken(&self, selectors: &[&str]) -> Vec<(String, TakenFor)> {
        let selectors: Vec<Selector> = selectors.iter().map(|s| s.parse().unwrap()).collect();
        let inspection = self.file.document().inspect(&selectors);
        let of_primitives = inspection.primitives.iter();
        of_primitives
            .map(|p| (p.nodes[0].clone(), p.taken_for))
            .collect()
    }

    fn is_plant(&self, node: &str) -> bool {
        let taken = self.taken(&[]);
        let found = taken.iter().find(|(name, _)| name == node).unwrap();
        found.1 != TakenFor::NotPlant
    }
}

/// A square at this height, two triangles.
fn square(half: f32, y: f32) -> Vec<[f32; 3]> {
    let corner = |x: f32, z: f32| [x * half, y, z * half];
    let [a, b, c, d] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    [a, b, c, a, c, d].map(|(x, z)| corner(x, z)).to_vec()
}

/// A box about the tree.
fn crate_about_it() -> Vec<[f32; 3]> {
    [square(3.0, 0.0), square(3.0, 5.0)].concat()
}

#[test]
fn helpers_are_not_the_plant_whatever_draws_them() {
    for name in ["Tree-colonly", "UCX_Tree_01", "Tree-navmesh.001"] {
        let garden = Garden::new().with_tree().with(name, 2, &crate_about_it());
        let inspection = garden.file.document().inspect(&[]);
        assert!(!garden.is_plant(name));
        // Neither its size nor its triangles are the plant's.
        let [low, high] = inspection.extents.unwrap();
        assert_eq!((low[1], high[1]), (0.0, 4.0));
        assert!(high[0] < 1.2, "{high:?}");
        assert_eq!(inspection.wood_triangles, 1);
        let document = garden.file.document();
        let drawn = document.drawn_as_one(Detail::Color).unwrap();
        let triangles: usize = drawn.iter().map(|d| d.surface.triangles.len()).sum();
        assert_eq!(triangles, 21);
        assert_eq!(document.surfaces(&[]).unwrap().len(), 2);
        assert_eq!(document.occluders().unwrap().triangles().len(), 21);
    }
}

#[test]
fn a_helper_is_noted_once_with_its_reason() {
    let garden = Garden::new().with_tree();
    let garden = garden.with("Tree-colonly", 2, &crate_about_it());
    let inspection = garden.file.document().inspect(&[]);
    let note = "1 node is no plant and stays as it is: Tree-colonly (collision)";
    assert_eq!(inspection.notes, [note]);
    let shown = inspection.to_string();
    let reason = "taken for no plant: its node is a collision shape by name";
    assert!(shown.contains(reason), "{shown}");
    assert!(shown.contains(&format!("note: {note}")), "{shown}");
    let two = garden.with("Plane", 2, &square(9.0, 0.0));
    let notes = two.file.document().inspect(&[]).notes;
    let note =
        "2 nodes are no plant and stay as they are: Tree-colonly (collision), Plane (ground)";
    assert_eq!(notes, [note]);
}

#[test]
fn what_is_below_a_helper_is_none_of_the_plant_either() {
    let mut garden = Garden::new().with_tree().with("Cube", 2, &crate_about_it());
    let group = garden
        .file
        .append("nodes", json!({"name": "UCX_all", "children": [2]}));
    garden.file.root["scenes"][0]["nodes"] = json!([0, 1, group]);
    assert!(!garden.is_plant("Cube"));
}

#[test]
fn a_trunk_that_things_bump_into_is_a_trunk() {
    // Godot draws `Trunk-col`. Textured, and without another trunk, it is one.
    let textured = |garden: Garden| {
        let file = garden.file.set("/images", json!([{"uri": "bark.png"}]));
        let file = file.set("/textures", json!([{"source": 0}]));
        let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
        Garden {
            file: file.set("/materials/2", material),
        }
    };
    let alone = Garden::new()
        .with_tree()
        .with("Trunk-col", 2, &crate_about_it());
    assert!(!alone.is_plant("Trunk-col"));
    assert!(textured(alone).is_plant("Trunk-col"));
    let another = Garden::new()
        .with_tree()
        .with("Leaves-col", 2, &crate_about_it());
    assert!(!textured(another).is_plant("Leaves-col"));
}

#[test]
fn ground_is_flat_wide_and_under_the_plant() {
    let with = |name: &str, corners: &[[f32; 3]]| Garden::new().with_tree().with(name, 2, corners);
    assert!(!with("Plane", &square(8.0, 0.0)).is_plant("Plane"));
    // A little below the foot of the tree, or thick, as terraces are.
    assert!(!with("Plane", &square(8.0, -0.2)).is_plant("Plane"));
    let slab = [square(8.0, 0.0), square(8.0, -0.03)].concat();
    assert!(!with("Terrace", &slab).is_plant("Terrace"));
    // As thick as a kerb: a thing of its own.
    let kerb = [square(8.0, 0.0), square(8.0, -0.3)].concat();
    assert!(with("Kerb", &kerb).is_plant("Kerb"));
    // A flat crown is above what bears it.
    assert!(with("Crown", &square(8.0, 4.0)).is_plant("Crown"));
    // A dish at the foot is not wide.
    assert!(with("Dish", &square(0.4, 0.0)).is_plant("Dish"));
    // A wall stands.
    let wall: Vec<[f32; 3]> = square(8.0, 0.0)
        .iter()
        .map(|&[x, y, z]| [x, z + 8.0, y])
        .collect();
    assert!(with("Wall", &wall).is_plant("Wall"));
}

#[test]
fn terraces_one_over_the_other_are_all_ground() {
    let garden = Garden::new()
        .with_tree()
        .with("Lawn", 2, &square(8.0, -0.1));
    let garden = garden.with("Paving", 2, &square(5.0, 0.0));
    assert!(!garden.is_plant("Lawn") && !garden.is_plant("Paving"));
}

#[test]
fn a_flat_plant_is_a_plant() {
    // Alone, and of many pieces with something on them: a water lily.
    let lily = Garden::new().with("lily", 0, &square(2.0, 0.0));
    assert!(lily.is_plant("lily"));
    let pad = |k: usize| {
        let [x, z] = [(k % 5) as f32 - 2.0, (k / 5) as f32 - 2.0];
        square(0.4, 0.0)
            .into_iter()
            .map(move |[a, y, b]| [a + x, y, b + z])
    };
    let pads: Vec<[f32; 3]> = (0..25).flat_map(pad).collect();
    let flower = [[-0.2, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let lily = Garden::new()
        .with("pads", 0, &pads)
        .with("flower", 1, &flower);
    assert!(lily.is_plant("pads"));
    // Flat things only: nothing stands on anything.
    let both = Garden::new()
        .with("lily", 0, &square(2.0, 0.0))
        .with("pond", 2, &square(4.0, -0.1));
    assert!(both.is_plant("lily") && both.is_plant("pond"));
}

#[test]
fn cut_out_cards_are_no_ground() {
    let garden = Garden::new().with_tree().with("Card", 2, &square(8.0, 0.0));
    let mut file = garden.file;
    file.texture(&image::RgbaImage::from_fn(2, 1, |x, _| {
        image::Rgba([9, 99, 9, 255 * x as u8])
    }));
    let material = |alpha: &str| json!({"alphaMode": alpha, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    for (alpha, is_plant) in [("MASK", true), ("BLEND", true), ("OPAQUE", false)] {
        let file = file.clone().set("/materials/2", material(alpha));
        assert_eq!(Garden { file }.is_plant("Card"), is_plant, "{alpha}");
    }
}

#[test]
fn ground_stays_in_scenes_of_obstacles() {
    let garden = Garden::new()
        .with_tree()
        .with("Plane", 2, &square(8.0, 0.0));
    let document = garden.file.document();
    assert_eq!(document.occluders().unwrap().triangles().len(), 23);
    assert_eq!(document.drawn_scene(Detail::Color).unwrap().len(), 3);
    assert_eq!(document.drawn_as_one(Detail::Color).unwrap().len(), 2);
}

#[test]
fn a_file_of_nothing_but_helpers_is_a_plant() {
    let garden = Garden::new().with("Bush-colonly", 0, &crate_about_it());
    assert!(garden.is_plant("Bush-colonly"));
}

#[test]
fn who_names_nothing_but_a_helper_gets_it() {
    let garden = Garden::new()
        .with_tree()
        .with("Tree-colonly", 2, &crate_about_it());
    let taken = |selector: &str| {
        let taken = garden.taken(&[selector]);
        let of_crate = taken.iter().find(|(node, _)| node == "Tree-colonly");
        of_crate.unwrap().1
    };
    assert_eq!(taken("node:Tree-colonly"), TakenFor::Foliage);
    assert_eq!(taken("node:*-colonly"), TakenFor::Foliage);
    assert_eq!(taken("material:stone"), TakenFor::Foliage);
    assert_eq!(taken("material:*"), TakenFor::NotPlant);
    assert_eq!(taken("material:leaf"), TakenFor::NotPlant);
    // What was named stays the plant's for whoever draws the document of the tree.
    let named: Selector = "node:Tree-colonly".parse().unwrap();
    let tree = garden.file.document().into_tree(&[named]).unwrap();
    let triangles = |document: &Document| -> usize {
        let drawn = document.drawn_as_one(Detail::Color).unwrap();
        drawn.iter().map(|d| d.surface.triangles.len()).sum()
    };
    assert_eq!(triangles(tree.document()), 25);
    let leaves = tree.foliage().leaves().len();
    let level = tree.lod_document(&secateur_model::Lod::original(leaves));
    assert_eq!(triangles(&level.unwrap()), 25);
}

#[test]
fn what_is_not_the_plant_stays_in_a_level_as_it_is() {
    let garden = Garden::new()
        .with_tree()
        .with("Plane", 2, &square(8.0, 0.0));
    let whole = garden.file.document().into_whole_tree(&[]).unwrap();
    assert_eq!(whole.items().foliage().triangles().len(), 21);
    let mut lod = secateur_model::Lod::original(whole.items().foliage().leaves().len());
    for leaf in 1..21 {
        lod.remove(secateur_model::LeafId::from_index(leaf));
    }
    let glb = whole.items().lod_to_bytes(&lod).unwrap();
    let level = Document::from_bytes("level.glb", glb, None).unwrap();
    let drawn = level.drawn_scene(Detail::Color).unwrap();
    let of_materials: Vec<(Option<usize>, usize)> = drawn
        .iter()
        .map(|d| (d.material, d.surface.triangles.len()))
        .collect();
    assert_eq!(of_materials, [(Some(0), 1), (Some(2), 2)]);
    let plane = |json: &Value| {
        let nodes = json["nodes"].as_array().unwrap();
        nodes.iter().find(|node| node["name"] == "Plane").cloned()
    };
    assert!(plane(level.json()).unwrap().get("mesh").is_some());
}

/// Nothing but its name tells a bench below a tree from wood.
#[test]
fn what_is_named_as_not_the_plant_is_neither_counted_nor_changed() {
    let garden = Garden::new()
        .with_tree()
        .with("Bench", 1, &crate_about_it());
    let selectors = |text: &str| [text.parse::<Selector>().unwrap()];
    let named = |text: &str| {
        let document = garden.file.document();
        document.with_not_plant(&selectors(text)).unwrap()
    };
    assert!(garden.is_plant("Bench"));
    let inspection = named("node:Bench").inspect(&[]);
    let bench = inspection.primitives.iter().find(|p| p.nodes == ["Bench"]);
    let bench = bench.unwrap();
    assert_eq!(bench.taken_for, TakenFor::NotPlant);
    assert!(bench.chosen_by_user);

    let whole = named("node:Bench").into_whole_tree(&[]).unwrap();
    assert_eq!(whole.items().foliage().triangles().len(), 21);
    let mut lod = secateur_model::Lod::original(21);
    for leaf in 1..21 {
        lod.remove(secateur_model::LeafId::from_index(leaf));
    }
    let glb = whole.items().lod_to_bytes(&lod).unwrap();
    let level = Document::from_bytes("level.glb", glb, None).unwrap();
    let count = |drawn: Vec<secateur_gltf::DrawnSurface>| -> usize {
        drawn.iter().map(|d| d.surface.triangles.len()).sum()
    };
    let bench = crate_about_it().len() / 3;
    assert_eq!(count(level.drawn_scene(Detail::Color).unwrap()), 1 + bench);
    let level = level.with_roles_of(whole.items());
    assert_eq!(count(level.drawn_as_one(Detail::Color).unwrap()), 1);

    // What is not the plant goes before leaves of the same name, and a name that is not there is refused.
    let leaves = selectors("material:*");
    let tree = named("node:Bench").into_tree(&leaves).unwrap();
    assert_eq!(tree.triangle_count(), 21);
    let error = named("node:Table").into_tree(&[]).unwrap_err().to_string();
    assert!(error.contains("`node:Table` matches nothing"), "{error}");
    assert!(named("all").into_tree(&[]).is_err());
}

/// Of the 20 leaves the first five are named; the others are wood, as the stem is.
#[test]
fn connected_pieces_are_named_by_numbers() {
    let garden = Garden::new().with_tree();
    let selectors = |text: &str| [text.parse::<Selector>().unwrap()];
    let whole = garden.file.document();
    let whole = whole.into_whole_tree(&selectors("piece:1.0.0-4")).unwrap();
    assert_eq!(whole.leaves().leaves().len(), 5);
    assert_eq!(whole.wood().leaves().len(), 16);
    let found = whole.items().inspection().primitives.iter();
    let found: Vec<TakenFor> = found.map(|p| p.taken_for).collect();
    assert_eq!(found, [TakenFor::Wood, TakenFor::FoliageInPart]);
    let runs: Vec<_> = whole.items().leaf_pieces().into_values().collect();
    assert_eq!(runs, [[[0, 4]]]);
    // Who names all of them names the part.
    let all = garden.file.document();
    let all = all.into_tree(&selectors("piece:1.0.0-19")).unwrap();
    assert_eq!(all.foliage().leaves().len(), 20);
    assert!(all.leaf_pieces().is_empty());
    for none in ["piece:1.0.20", "piece:1.1.0", "piece:7.0.0"] {
        let error = garden.file.document().into_tree(&selectors(none));
        let error = error.unwrap_err().to_string();
        assert!(error.contains("matches nothing"), "{error}");
    }
}

/// Leaf 14 has the largest z, the sine of 14: from there it is met first, and beside it nothing is.
#[test]
fn a_ray_meets_the_nearest_piece() {
    let garden = Garden::new().with_tree();
    let tree = garden.file.document().into_tree(&[]).unwrap();
    let leaves = &tree.inspection().primitives[1].place;
    let [x, y] = [14f64.cos() + 0.02, 2.0 + 1.4 + 0.02];
    let met = |x: f64| {
        tree.piece_at(leaves, [x, y, 9.0], [0.0, 0.0, -1.0])
            .unwrap()
    };
    let piece = met(x).unwrap();
    assert_eq!(piece.number, 14);
    assert_eq!(piece.triangles.len(), 1);
    assert_eq!(met(9.0), None);
    assert!(
        tree.piece_at("meshes[9].primitives[0]", [0.0; 3], [1.0; 3])
            .unwrap()
            .is_none()
    );
}

/// A file of the shared folder of small cases, or `None`, said aloud.
pub(crate) fn case(name: &str) -> Option<Document> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/cases");
    let path = PathBuf::from(folder).join(name);
    if path.is_file() {
        return Some(Document::open(&path).unwrap());
    }
    eprintln!("SKIPPED: ../shared/cases/{name} is not there");
    None
}

#[test]
fn cases_of_strangers_are_the_plant_alone() {
    for (name, note) in [
        (
            "colonly.glb",
            "1 node is no plant and stays as it is: Tree-colonly (collision)",
        ),
        (
            "ground.glb",
            "1 node is no plant and stays as it is: Plane (ground)",
        ),
    ] {
        let (Some(document), Some(base)) = (case(name), case("base.glb")) else {
            continue;
        };
        let (found, base) = (document.inspect(&[]), base.inspect(&[]));
        assert_eq!(found.notes, [note]);
        assert_eq!(found.extents, base.extents, "{name}");
        assert_eq!(found.wood_triangles, base.wood_triangles, "{name}");
        assert_eq!(found.foliage, base.foliage, "{name}");
    }
    for name in [
        "lily_flat.glb",
        "lily_flat_ds.glb",
        "pot.glb",
        "grass2.glb",
        "pack5.glb",
    ] {
        if let Some(document) = case(name) {
            assert_eq!(document.inspect(&[]).notes, [""; 0], "{name}");
        }
    }
}

/// Of the 20 leaves two are no plant: they become a primitive of their own, which levels keep and nobody judges.
#[test]
fn pieces_that_are_not_the_plant_stay_as_they_are_and_are_not_judged() {
    let garden = Garden::new().with_tree();
    let selectors = |text: &str| [text.parse::<Selector>().unwrap()];
    let named = |text: &str| garden.file.document().with_not_plant(&selectors(text));
    let document = named("piece:1.0.3-4").unwrap();
    let (place, others) = document.other_pieces().into_iter().next().unwrap();
    assert_eq!(others.runs, [[3, 4]]);
    assert!(place.ends_with("primitives[1]") && others.source.ends_with("primitives[0]"));
    let inspection = document.inspect(&[]);
    let half = inspection.primitives.iter().find(|p| p.place == place);
    assert_eq!(half.unwrap().taken_for, TakenFor::NotPlant);
    assert!(
        inspection
            .notes
            .iter()
            .any(|note| note.starts_with("2 pieces are no plant"))
    );

    // Numbers stay those of the file: the leaf behind them is the sixth.
    let whole = document
        .into_whole_tree(&selectors("piece:1.0.2-5"))
        .unwrap();
    assert_eq!(whole.leaves().leaves().len(), 2);
    assert_eq!(whole.items().foliage().triangles().len(), 19);
    let runs: Vec<_> = whole.items().leaf_pieces().into_values().collect();
    assert_eq!(runs, [[[2, 2], [5, 5]]]);

    // What is left of the plant is one leaf; who reads the level knows the others as no plant, by itself or its plant.
    let whole = named("piece:1.0.3-4")
        .unwrap()
        .into_whole_tree(&[])
        .unwrap();
    let mut lod = secateur_model::Lod::original(19);
    for leaf in 1..19 {
        lod.remove(secateur_model::LeafId::from_index(leaf));
    }
    let glb = whole.items().lod_to_bytes(&lod).unwrap();
    let count = |drawn: Vec<secateur_gltf::DrawnSurface>| -> [usize; 2] {
        let surfaces = drawn.iter().map(|d| &d.surface);
        let counts = surfaces.map(|s| [s.triangles.len(), s.positions.len()]);
        counts.fold([0; 2], |[t, v], [more, vertices]| [t + more, v + vertices])
    };
    let level = || Document::from_bytes("level.glb", glb.clone(), None).unwrap();
    assert_eq!(count(level().drawn_scene(Detail::Color).unwrap()), [3, 9]);
    assert_eq!(count(level().drawn_as_one(Detail::Color).unwrap()), [1, 3]);
    let level = level().with_roles_of(whole.items());
    assert_eq!(count(level.drawn_as_one(Detail::Color).unwrap()), [1, 3]);

    // All pieces of a primitive are all of it; what is not there is refused.
    let whole = named("piece:1.0.0-19")
        .unwrap()
        .into_whole_tree(&[])
        .unwrap();
    assert_eq!(whole.items().foliage().triangles().len(), 1);
    for none in ["piece:1.0.20", "piece:1.1.0", "piece:7.0.0"] {
        let error = named(none).unwrap_err().to_string();
        assert!(error.contains("matches nothing"), "{error}");
    }
}
