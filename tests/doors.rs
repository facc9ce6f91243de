//! What a glTF from elsewhere may not do: put files where they do harm, and
//! fetch files from outside its own folder.

use std::fs;

use serde_json::{Value, json};

use crate::program::{Bench, Ran};
use crate::small_files::{put_changed, two_leaves, two_leaves_json};

/// Puts the tree of two leaves into `in`, with these images, and makes `out`.
/// Textures name the first `used` images.
fn put_with_images(images: &[&str], used: usize) -> Bench {
    let bench = Bench::new();
    for folder in ["in", "out"] {
        fs::create_dir(bench.path(folder)).unwrap();
    }
    let mut json = two_leaves_json();
    json["images"] = images.iter().map(|uri| json!({ "uri": uri })).collect();
    json["textures"] = (0..used).map(|image| json!({ "source": image })).collect();
    bench.put("in/t.gltf", json.to_string().as_bytes());
    bench.put("in/tree.bin", &two_leaves());
    bench
}

fn put_file(bench: &Bench, name: &str, bytes: &[u8]) {
    fs::create_dir_all(bench.path(name).parent().unwrap()).unwrap();
    bench.put(name, bytes);
}

fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::new(1, 1)
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

fn simplify(bench: &Bench) -> Ran {
    bench.simplify(&[
        "in/t.gltf",
        "-o",
        "out/o.glb",
        "--ratio",
        "0.5",
        "--report",
        "r.json",
    ])
}

/// What lies in `out` itself.
fn out(bench: &Bench) -> Vec<String> {
    let entries = fs::read_dir(bench.path("out")).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[track_caller]
fn assert_noted(bench: &Bench, parts: &[&str]) {
    let report = bench.json("r.json");
    let notes = report["notes"].as_array().unwrap().iter();
    let notes: Vec<&str> = notes.filter_map(Value::as_str).collect();
    let says = |note: &&str| parts.iter().all(|part| note.contains(part));
    assert!(notes.iter().any(says), "{parts:?}: {notes:?}");
}

#[test]
fn files_that_are_no_images_are_not_put_into_the_output() {
    let uris = [".cargo/config.toml", ".envrc", ".git/hooks/x", "Makefile"];
    for used in [0, uris.len()] {
        let bench = put_with_images(&uris, used);
        for uri in uris {
            put_file(&bench, &format!("in/{uri}"), b"harm = true");
        }
        let ran = simplify(&bench).succeeded();
        assert_eq!(out(&bench), ["o.glb"]);
        for uri in uris {
            assert_noted(&bench, &[uri, "was not copied"]);
            assert!(ran.stdout.contains(uri), "{}", ran.stdout);
        }
    }
}

#[test]
fn textures_are_put_into_the_output() {
    let bench = put_with_images(&["maps/leaf.png"], 1);
    put_file(&bench, "in/maps/leaf.png", &png());
    simplify(&bench).succeeded();
    assert_eq!(out(&bench), ["maps", "o.glb"]);
    assert_eq!(bench.read("out/maps/leaf.png"), png());
    assert_noted(&bench, &["`maps/leaf.png` was copied to"]);
}

#[cfg(unix)]
#[test]
fn nothing_is_written_through_a_link_in_the_output() {
    let bench = put_with_images(&["maps/leaf.png"], 1);
    put_file(&bench, "in/maps/leaf.png", &png());
    fs::create_dir(bench.path("elsewhere")).unwrap();
    std::os::unix::fs::symlink(bench.path("elsewhere"), bench.path("out/maps")).unwrap();
    simplify(&bench).succeeded();
    assert!(!bench.path("elsewhere/leaf.png").exists());
    assert_noted(&bench, &["`maps/leaf.png` was not copied", "symbolic link"]);
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_of_the_input_are_refused() {
    use std::os::unix::fs::symlink;

    let bench = put_with_images(&["leaf.png"], 1);
    put_file(&bench, "private/photo.png", &png());
    symlink(bench.path("private/photo.png"), bench.path("in/leaf.png")).unwrap();
    let parts = ["in/t.gltf: images[0]: ", "`leaf.png`", "symbolic link"];
    simplify(&bench).failed_saying(&parts);
    assert_eq!(out(&bench), [] as [&str; 0]);

    let bench = put_with_images(&[], 0);
    fs::rename(bench.path("in/tree.bin"), bench.path("secret")).unwrap();
    symlink("../secret", bench.path("in/tree.bin")).unwrap();
    let parts = ["in/t.gltf: buffers[0]: ", "`tree.bin`", "symbolic link"];
    simplify(&bench).failed_saying(&parts);
    assert_eq!(out(&bench), [] as [&str; 0]);
}

#[cfg(unix)]
#[test]
fn a_link_that_the_user_names_is_followed() {
    let bench = put_with_images(&[], 0);
    std::os::unix::fs::symlink("in/t.gltf", bench.path("link.gltf")).unwrap();
    bench
        .simplify(&["link.gltf", "-o", "out/o.glb", "--leaves", "1"])
        .succeeded();
    // As an output too: what it leads to is written, and the buffer beside that.
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    bench
        .simplify(&["tree.gltf", "-o", "link.gltf", "--leaves", "1"])
        .succeeded();
    assert!(bench.path("link.gltf").is_symlink());
    let written = bench.json("in/t.gltf");
    assert_eq!(written["buffers"][0]["uri"], "t.bin");
    assert!(bench.path("in/t.bin").exists() && !bench.path("link.bin").exists());
}

#[test]
fn a_run_that_fails_leaves_none_of_its_files() {
    // The tree's colours are none.
    let bench = Bench::new();
    put_changed(
        &bench,
        "/meshes/0/primitives/0/attributes/COLOR_0",
        json!(1),
    );
    let before = bench.names();
    for output in ["o.gltf", "o.glb"] {
        let arguments = ["tree.gltf", "-o", output, "--leaves", "1", "--fit=none"];
        let more = [
            "--sides",
            "both",
            "--picture",
            "p.png",
            "--report",
            "r.json",
            "--debug-images",
            "d",
        ];
        let ran = bench.simplify(&[&arguments[..], &more].concat());
        ran.failed_saying(&["COLOR_0"]);
        assert_eq!(bench.names(), before);
    }
}

#[test]
fn debug_images_do_not_replace_images_of_the_input() {
    let bench = put_with_images(&["after-view-00.png"], 1);
    put_file(&bench, "in/after-view-00.png", &png());
    let arguments = [
        "in/t.gltf",
        "-o",
        "out/o.glb",
        "--leaves",
        "1",
        "--fit=none",
        "--sides",
        "both",
    ];
    bench
        .simplify(&[&arguments[..], &["--debug-images", "in"]].concat())
        .failed_saying(&["after-view-00.png", "an image of the input"]);
    assert_eq!(bench.read("in/after-view-00.png"), png());
    assert_eq!(out(&bench), [] as [&str; 0]);
}

#[test]
fn a_buffer_of_somebody_else_is_overwritten_only_on_demand() {
    let bench = Bench::new();
    put_changed(&bench, "/nodes/0/name", json!("tree"));
    bench.put("o.bin", b"mine");
    let arguments = ["tree.gltf", "-o", "o.gltf", "--leaves", "1"];
    let parts = ["o.gltf: ", "`o.bin`", "--overwrite"];
    bench.simplify(&arguments).failed_saying(&parts);
    assert_eq!(bench.read("o.bin"), b"mine");
    assert!(!bench.path("o.gltf").exists());

    let on_demand = [&arguments[..], &["--overwrite"]].concat();
    bench.simplify(&on_demand).succeeded();
    let first = bench.read("o.bin");
    // Now it is the output's own.
    bench
        .simplify(&["tree.gltf", "-o", "o.gltf", "--leaves", "2"])
        .succeeded();
    assert_ne!(bench.read("o.bin"), first);
    assert_eq!(
        bench.names(),
        ["o.bin", "o.gltf", "oak.glb", "tree.bin", "tree.gltf"]
    );
}

/// Names that nobody gave are not followed: what links lead to stays as it is.
#[cfg(unix)]
#[test]
fn links_in_the_place_of_a_note_a_level_or_a_buffer_are_replaced() {
    use std::os::unix::fs::symlink;

    let bench = Bench::for_small_screen();
    put_file(&bench, "mine", b"mine");
    fs::create_dir(bench.path("chain")).unwrap();
    for name in [".oak_lods.json", "oak_LOD0.glb"] {
        symlink(bench.path("mine"), bench.path(&format!("chain/{name}"))).unwrap();
    }
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "chain",
        "--levels",
        "0.1",
        "--impostor",
        "none",
    ];
    bench
        .run(&[&lods[..], &["--overwrite"]].concat())
        .succeeded();
    assert_eq!(bench.read("mine"), b"mine");
    assert!(!bench.path("chain/oak_LOD0.glb").is_symlink());

    put_changed(&bench, "/nodes/0/name", json!("tree"));
    symlink(bench.path("mine"), bench.path("o.bin")).unwrap();
    let arguments = ["tree.gltf", "-o", "o.gltf", "--leaves", "1", "--overwrite"];
    bench.simplify(&arguments).succeeded();
    assert_eq!(bench.read("mine"), b"mine");
    assert!(!bench.path("o.bin").is_symlink());
}

/// A note may name any file; those without an end are not read.
#[cfg(target_os = "linux")]
#[test]
fn what_a_note_names_is_read_only_if_it_ends() {
    let bench = Bench::for_small_screen();
    let lods = [
        "lods",
        "oak.glb",
        "-o",
        "chain",
        "--levels",
        "0.1",
        "--impostor",
        "none",
    ];
    bench.run(&lods).succeeded();
    let mut note = bench.json("chain/.oak_lods.json");
    note["files"][0]["file"] = json!("/dev/zero");
    bench.put("chain/.oak_lods.json", note.to_string().as_bytes());
    bench
        .run(&lods)
        .failed_saying(&["oak_LOD0.glb", "is there already"]);
}

/// Before the work, not after it.
#[test]
fn names_that_no_file_can_have_are_refused_first() {
    let bench = Bench::new();
    let long = format!("{}.glb", "x".repeat(300));
    let arguments = ["no tree.glb", "-o", &long, "--leaves", "1"];
    bench
        .simplify(&arguments)
        .lacked_saying(&["xxx", "cannot be written"]);
    for name in ["a;b:c.glb", ".oak.glb"] {
        bench.put(name, crate::program::oak());
        bench
            .run(&["lods", name, "-o", "chain"])
            .failed_saying(&[name, "name"]);
    }
}

/// `lods` reads a plant to know it again, and once more to make it lighter.
#[cfg(unix)]
#[test]
fn a_pipe_is_refused_where_a_plant_is_read_twice() {
    let bench = Bench::new();
    let ran = bench.run_in_shell("cat oak.glb | \"$SECATEUR\" lods /dev/stdin -o chain");
    ran.failed_saying(&["/dev/stdin", "is a pipe", "name a file"]);
}
