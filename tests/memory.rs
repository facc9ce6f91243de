//! What takes more memory than is allowed is refused in one sentence.

use serde_json::json;

use crate::program::Bench;
use crate::small_files::{put_changed, two_leaves, two_leaves_json};

/// A tree whose two leaves stand at one place, repeated this often.
fn pile(leaves: usize) -> Bench {
    let bench = Bench::new();
    let nodes: Vec<_> = (0..leaves / 2).map(|_| json!({ "mesh": 0 })).collect();
    let mut json = two_leaves_json();
    json["scenes"][0]["nodes"] = (0..nodes.len()).collect();
    json["nodes"] = nodes.into();
    bench.put("tree.gltf", json.to_string().as_bytes());
    bench.put("tree.bin", &two_leaves());
    bench
}

fn white_png(side: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(side, side, image::Rgba([255; 4]))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

/// A megabyte does for no tree, whatever is done with it.
#[test]
fn every_command_that_reads_trees_keeps_to_its_memory() {
    let bench = Bench::new();
    let before = bench.names();
    for arguments in [
        &["simplify", "oak.glb", "-o", "o.glb", "--leaves", "9"][..],
        &["lods", "oak.glb", "-o", "chain"],
        &["measure", "oak.glb", "oak.glb"],
        &["study", "oak.glb", "-o", "study", "--levels", "0.5"],
        &["demo", "-o", "demo", "--leaves", "900"],
    ] {
        let ran = bench.run(&[arguments, &["--memory", "100K"]].concat());
        ran.lacked_saying(&["would take", "of memory", "`--memory`"]);
        assert_eq!(bench.names(), before, "{arguments:?}");
    }
    let arguments = ["oak.glb", "-o", "o.glb", "--leaves", "9", "--memory"];
    for wrong in ["0", "lots", "2X"] {
        let ran = bench.run(&[&["simplify"], &arguments[..], &[wrong]].concat());
        ran.misused_saying(&["2G or 800M"]);
    }
    let ran = bench.simplify(&[&arguments[..], &["200M", "--fit=none"]].concat());
    ran.succeeded();
}

/// What counts tell is refused before anything is drawn, in one sentence about all that levels need.
#[test]
fn levels_that_do_not_fit_say_what_all_of_them_take() {
    let bench = Bench::new();
    let ran = bench.run(&["lods", "oak.glb", "-o", "chain", "--memory", "600M"]);
    ran.lacked_saying(&["levels of", "triangles of wood would take 6", "`--memory`"]);
}

/// 1,000 leaves behind each other: seven kilobytes as a file, 7 MiB as lists. The
/// answer does not depend on who counts.
#[test]
fn leaves_behind_each_other_are_counted_before_they_take_memory() {
    let bench = pile(1000);
    let arguments = [
        "tree.gltf",
        "-o",
        "o.glb",
        "--leaves",
        "9",
        "--memory",
        "6M",
        "--sides",
        "both",
    ];
    let mut answers = Vec::new();
    for threads in ["1", "3"] {
        let ran = bench.simplify(&[&arguments[..], &["--threads", threads]].concat());
        answers.push(ran.stderr.clone());
        let views = "6 views of 64 x 64 pixels";
        ran.lacked_saying(&["1000 leaves behind each other", views, "`--resolution`"]);
    }
    assert_eq!(answers[0], answers[1]);
    assert!(!bench.path("o.glb").exists());
    let few = ["--resolution", "8", "--fit=none"];
    bench
        .run(&[&["simplify"], &arguments[..], &few].concat())
        .succeeded();
}

/// A file of 16 kB, whose header says what it will be.
#[test]
fn images_are_reckoned_by_their_headers() {
    let bench = Bench::new();
    put_changed(
        &bench,
        "/materials/0/pbrMetallicRoughness",
        json!({ "baseColorTexture": { "index": 0 } }),
    );
    let mut json = bench.json("tree.gltf");
    json["textures"] = json!([{ "source": 0 }]);
    json["images"] = json!([{ "uri": "leaf.png" }]);
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(2);
    let uvs = json!({ "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC2" });
    json["accessors"].as_array_mut().unwrap().push(uvs);
    bench.put("tree.gltf", json.to_string().as_bytes());
    bench.put("leaf.png", &white_png(2048));
    let inspect = |memory| bench.run(&["measure", "tree.gltf", "tree.gltf", "--memory", memory]);
    inspect("40M").lacked_saying(&[
        "images[0]",
        "2048 x 2048 texels",
        "48.0 MiB",
        "images smaller",
    ]);
}

/// One file under 400 names is in memory once.
#[test]
fn a_file_that_is_named_often_is_taken_once() {
    let bench = Bench::new();
    let mut json = two_leaves_json();
    let big = json!({ "uri": "big.bin", "byteLength": 4 << 20 });
    let buffers = json["buffers"].as_array_mut().unwrap();
    buffers.extend((0..400).map(|_| big.clone()));
    bench.put("tree.gltf", json.to_string().as_bytes());
    bench.put("tree.bin", &two_leaves());
    bench.put("big.bin", &vec![7; 4 << 20]);
    let inspect = |memory| bench.run(&["inspect", "tree.gltf", "--memory", memory]);
    inspect("6M").succeeded();
    inspect("3M").lacked_saying(&["buffers[1]", "`big.bin`", "4.0 MiB"]);
}

/// 4,000 leaves behind each other would take .4 GiB in these views: a process that may have .6 GiB
/// of addresses says so, where it was aborted in the middle.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_process_are_kept_to() {
    let bench = pile(4000);
    // Drivers of GPUs do not keep to limits: the audit would ask one.
    let ran = bench.run_in_shell(
        "ulimit -v 600000; exec \"$SECATEUR\" simplify tree.gltf -o o.glb --leaves 9 --sides both \
         --views 6 --resolution 256 --engine cpu --threads 2 --no-audit",
    );
    ran.lacked_saying(&["4000 leaves behind each other", "`--memory`"]);
    assert!(!bench.path("o.glb").exists());
}
