//! A folder of somebody's plants, of all kinds, in one call.

use secateur::{Document, Tree, plant_to_glb};
use secateur_plant::{GrowOptions, Species, grow};
use serde_json::{Value, json};

use crate::glb::{chunks, joined};
use crate::program::Bench;

/// A change of the JSON of a plant.
type Edit = fn(&mut Value);

fn nodes(root: &mut Value) -> &mut Vec<Value> {
    root["nodes"].as_array_mut().unwrap()
}

/// Puts the plant below a node with this transform.
fn below(root: &mut Value, mut node: Value) {
    node["children"] = root["scenes"][0]["nodes"].clone();
    nodes(root).push(node);
    let number = nodes(root).len() - 1;
    root["scenes"][0]["nodes"] = json!([number]);
}

/// Draws the mesh of a node once more, by another node.
fn again(root: &mut Value, mut node: Value) {
    let drawn = nodes(root).iter().find(|node| node.get("mesh").is_some());
    node["mesh"] = drawn.unwrap()["mesh"].clone();
    nodes(root).push(node);
    let number = nodes(root).len() - 1;
    root["scenes"][0]["nodes"]
        .as_array_mut()
        .unwrap()
        .push(number.into());
}

fn each_material(root: &mut Value, change: impl Fn(&mut Value)) {
    root["materials"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .for_each(change);
}

fn without_names(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(without_names),
        Value::Object(fields) => {
            fields.retain(|key, value| key != "name" || !value.is_string());
            fields.values_mut().for_each(without_names);
        }
        _ => {}
    }
}

/// What strangers' exporters do to a plant.
const KINDS: [(&str, Edit); 16] = [
    ("plain", |_| {}),
    ("unnamed", without_names),
    ("placed", |root| {
        below(root, json!({"translation": [100, 0, -50]}))
    }),
    ("centimetres", |root| {
        below(root, json!({"scale": [0.01, 0.01, 0.01]}))
    }),
    ("mirrored", |root| below(root, json!({"scale": [-1, 1, 1]}))),
    ("lying", |root| {
        below(root, json!({"rotation": [-0.6, 0, 0, 0.8]}))
    }),
    ("blended", |root| {
        each_material(root, |m| m["alphaMode"] = "BLEND".into())
    }),
    ("opaque", |root| {
        each_material(root, |m| m["alphaMode"] = "OPAQUE".into())
    }),
    ("bare_materials", |root| {
        each_material(root, |m| *m = json!({"name": m["name"]}))
    }),
    ("collider", |root| {
        again(root, json!({"name": "plant-colonly"}))
    }),
    ("two", |root| {
        again(root, json!({"name": "second", "translation": [40, 0, 0]}))
    }),
    ("camera", |root| {
        root["cameras"] =
            json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
        below(root, json!({"camera": 0}));
    }),
    ("lit", |root| {
        root["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        root["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
        below(
            root,
            json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}),
        );
    }),
    ("no_normals", |root| {
        for mesh in root["meshes"].as_array_mut().unwrap() {
            for primitive in mesh["primitives"].as_array_mut().unwrap() {
                primitive["attributes"]
                    .as_object_mut()
                    .unwrap()
                    .remove("NORMAL");
            }
        }
    }),
    ("unlit", |root| {
        root["extensionsUsed"] = json!(["KHR_materials_unlit"]);
        each_material(root, |m| {
            m["extensions"] = json!({"KHR_materials_unlit": {}})
        });
    }),
    (
        "signed",
        |root| root["asset"] = json!({"version": "2.0", "generator": "Tree Tool 3", "extras": 7}),
    ),
];

fn grown(species: Species) -> Vec<u8> {
    let options = GrowOptions {
        leaves: 16,
        seed: 3,
    };
    plant_to_glb(&grow(species, &options).unwrap())
}

/// Every good file has its levels, and the bad ones are told of: exit code 3.
#[test]
fn a_folder_of_all_kinds_gets_its_levels_in_one_call() {
    let bench = Bench::new();
    let mut good = Vec::new();
    let mut put = |name: &str, glb: &[u8]| {
        good.push(name.to_owned());
        bench.put(&format!("{name}.glb"), glb);
    };
    let plant = grown(Species::Birch);
    let (json, bin) = chunks(&plant);
    let of_kind = |edit: Edit| {
        let mut root: Value = serde_json::from_slice(json).unwrap();
        edit(&mut root);
        joined(&root, bin)
    };
    for (name, edit) in KINDS {
        put(name, &of_kind(edit));
    }
    put("pine", &grown(Species::Pine));
    put("maple", &grown(Species::Maple));
    let how = [
        "--effort=fast",
        "--levels",
        "0.5",
        "--no-original",
        "--impostor",
        "none",
        "--screen-height",
        "64",
    ];
    let call =
        |trees: &[&str], to: &str| bench.run(&[&["lods"], trees, &["-o", to][..], &how].concat());
    for layout in ["siblings", "msft", "files"] {
        let to = if layout == "files" { "." } else { "all.glb" };
        let made = bench.run(
            &[
                &[
                    "lods",
                    "plain.glb",
                    "-o",
                    to,
                    "--layout",
                    layout,
                    "--overwrite",
                ],
                &how[..2],
                &how[3..],
            ]
            .concat(),
        );
        made.succeeded();
        let file = if layout == "files" {
            "plain_LOD1.glb"
        } else {
            "all.glb"
        };
        put(&format!("levels_{layout}"), &bench.read(file));
    }
    let cut = &plant[..plant.len() / 2];
    let empty = joined(&json!({"asset": {"version": "2.0"}}), &[]);
    let bad: [(&str, &[u8]); 3] = [("cut", cut), ("text", b"not a plant"), ("empty", &empty)];
    for (name, bytes) in bad {
        bench.put(&format!("{name}.glb"), bytes);
    }
    let names = good
        .iter()
        .map(String::as_str)
        .chain(bad.map(|(name, _)| name));
    let files: Vec<String> = names.map(|name| format!("{name}.glb")).collect();
    assert_eq!(files.len(), 24);
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let ran = call(&files, "levels");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert!(ran.stdout.contains("3 of 24 failed"), "{}", ran.stdout);
    for name in good {
        let level = bench.path(&format!("levels/{name}_LOD0.glb"));
        let [before, after] = [bench.path(&format!("{name}.glb")), level.clone()]
            .map(|file| Tree::open(&file, &[]).unwrap().triangle_count());
        assert!(after < before, "{name}: {after} of {before} triangles");
        let drawn = Document::open(&level).unwrap().surfaces(&[]).unwrap();
        assert!(!drawn.is_empty(), "{name}");
    }
    for (name, _) in bad {
        assert!(
            ran.stderr.contains(&format!("{name}.glb: ")),
            "{name}: {}",
            ran.stderr
        );
    }
}
