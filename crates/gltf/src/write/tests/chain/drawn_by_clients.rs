//! Chains as three.js and Babylon.js draw them.

use super::fixtures::{picture, with_skin};
use super::*;

/// A tree large enough to be looked at: leaves with a texture below a node that
/// mirrors and turns.
fn to_look_at() -> Fixture {
    let mut fixture = Fixture::new();
    let leaf = |k: usize| {
        let (x, y) = ((k % 6) as f32 * 1.5, (k / 6) as f32 * 1.5);
        [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]].map(|[x, y]| [x, y, 0.1 * x])
    };
    let positions: Vec<[f32; 3]> = (0..30).flat_map(leaf).collect();
    let attributes = json!({
        "POSITION": fixture.vectors(&positions),
        "NORMAL": fixture.vectors(&[[0.0, 0.0, 1.0]; 120]),
        "TEXCOORD_0": fixture.vectors(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].repeat(30)),
    });
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(30));
    let mut fixture = fixture.with_leaves(attributes, Some(indices));
    let view = fixture.view(&encodings::one_texel_png(), None);
    fixture.root["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    fixture.root["textures"] = json!([{"source": 0}]);
    fixture.root["materials"] = json!([
        {"name": "bark", "doubleSided": true,
         "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.2, 0.1, 1.0], "metallicFactor": 0}},
        {"name": "leaf",
         "pbrMetallicRoughness": {"baseColorFactor": [0.6, 1.0, 0.4, 1.0], "metallicFactor": 0,
                                  "baseColorTexture": {"index": 0}}},
    ]);
    fixture.root["nodes"][2]["scale"] = json!([-1, 1, 1]);
    fixture.root["nodes"][2]["translation"] = json!([6, 0, 0]);
    fixture.root["nodes"][0]["rotation"] = json!([0, 0.28, 0, 0.96]);
    fixture
}

/// What the tests show to clients, with its name.
fn shown() -> Vec<(&'static str, Fixture)> {
    let mut skinned = to_look_at();
    with_skin(&mut skinned, 0, 4);
    with_skin(&mut skinned, 1, 120);
    let nodes = skinned.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "joint", "rotation": [0, 0, 0.28, 0.96]}));
    // A node of a skinned mesh is best a root: what is above it does not count.
    for node in nodes.iter_mut().take(3).skip(1) {
        node["skin"] = 0.into();
    }
    nodes[2]
        .as_object_mut()
        .unwrap()
        .retain(|name, _| ["name", "mesh", "skin"].contains(&&**name));
    nodes[0] = json!({"name": "tree", "children": [3]});
    skinned.root["scenes"][0]["nodes"] = json!([0, 1, 2]);
    skinned.root["skins"] = json!([{"joints": [3]}]);

    let mut instanced = to_look_at();
    let moves = instanced.vectors(&[[0.0, 0.0, 0.0], [1.0, 9.0, 1.0]]);
    let attributes = json!({ "TRANSLATION": moves });
    instanced.instance(attributes.as_object().unwrap().clone());
    vec![
        ("one-mesh", to_look_at()),
        ("skinned", skinned),
        ("instanced", instanced),
    ]
}

#[test]
fn three_js_and_babylon_js_draw_every_level() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture();
    let mut jobs = Vec::new();
    let mut triangles = std::collections::HashMap::new();
    for (name, fixture) in shown() {
        let tree = fixture.tree();
        let count = tree.foliage.leaves().len();
        let mut lods = vec![Lod::original(count); 3];
        for index in 0..count {
            let leaf = LeafId::from_index(index);
            if index % 2 == 0 {
                lods[1].remove(leaf);
            }
            match index % 6 {
                1 => lods[2].resize(leaf, 2.0),
                _ => lods[2].remove(leaf),
            }
        }
        let input = format!("{name}.glb");
        std::fs::write(folder.path().join(&input), fixture.glb()).unwrap();
        let mut layouts = Vec::new();
        for layout in LAYOUTS {
            let mut levels = levels(&lods);
            levels[2].facts["screen_coverage"] = json!(0.1);
            let facts = json!({"screen_coverage": 0.0});
            let facts = facts.as_object().unwrap().clone();
            levels.push(Level::of_surface("oak", 3, &picture, facts));
            let chain = tree.chain_to_bytes("oak", &levels, layout).unwrap();
            let mut files = Vec::new();
            for file in &chain.files {
                let path = format!("{name}-{layout:?}-{}", file.name);
                std::fs::write(folder.path().join(&path), &file.bytes).unwrap();
                files.push(format!("/{path}"));
            }
            let names = ["oak_LOD0", "oak_LOD1", "oak_LOD2", "oak_LOD3"];
            layouts.push(json!({"layout": format!("{layout:?}"), "files": files, "names": names}));
            triangles.insert(name, chain.triangles);
        }
        jobs.push(json!({"name": name, "input": format!("/{input}"), "layouts": layouts}));
    }
    let path = folder.path().join("jobs.json");
    std::fs::write(&path, json!(jobs).to_string()).unwrap();
    let Some(seen) = super::super::clients::show("page.js", &path) else {
        return;
    };
    assert_eq!(seen.len(), shown().len() * 2 * LAYOUTS.len());
    for chain in seen {
        eprintln!("{chain}");
        let expected = &triangles[chain["name"].as_str().unwrap()];
        let levels = chain["levels"].as_array().unwrap();
        let found: Vec<f64> = levels
            .iter()
            .map(|l| l["triangles"].as_f64().unwrap())
            .collect();
        assert_eq!(
            found,
            expected.iter().map(|&n| n as f64).collect::<Vec<_>>(),
            "{chain}"
        );
        assert!(found.is_sorted_by(|a, b| a > b), "{chain}");
        for level in levels {
            assert!(level["covered"].as_f64().unwrap() > 0.02, "blank: {chain}");
            assert!(
                level["colours"].as_u64().unwrap() > 1,
                "one colour: {chain}"
            );
        }
        // The finest level looks as the input does.
        assert!(
            chain["differs_from_input"].as_f64().unwrap() < 0.002,
            "{chain}"
        );
        if chain["layout"] == "Msft" {
            // JavaScript does not tell 0 from 0.0.
            let coverage: Vec<f64> = chain["coverage"]
                .as_array()
                .unwrap()
                .iter()
                .map(|c| c.as_f64().unwrap())
                .collect();
            assert_eq!(coverage, [0.5, 0.2, 0.1, 0.0], "{chain}");
        }
    }
}
