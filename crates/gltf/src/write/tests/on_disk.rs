//! Files: beside each other, all or none.

use std::fs;
use std::path::Path;

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use super::fixture::{Fixture, read};
use super::validator::assert_valid;
use crate::{Document, Problem, Selector, Tree, WriteProblem};

fn open(path: &Path) -> Tree {
    let leaves = [Selector::Material("leaf".to_owned())];
    Document::open(path).unwrap().into_tree(&leaves).unwrap()
}

/// A .gltf, its .bin, and its image in a folder of its own.
fn write_apart(folder: &Path) {
    let Fixture { mut root, bin } = encodings::textured();
    root["buffers"] = serde_json::json!([{"uri": "in%20parts.bin", "byteLength": bin.len()}]);
    root["images"] = serde_json::json!([{"uri": "textures/leaf.png"}]);
    fs::write(folder.join("in parts.gltf"), root.to_string()).unwrap();
    fs::write(folder.join("in parts.bin"), bin).unwrap();
    fs::create_dir(folder.join("textures")).unwrap();
    fs::write(folder.join("textures/leaf.png"), encodings::one_texel_png()).unwrap();
}

fn file_names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_gltf_brings_its_buffer_and_images_along() {
    let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write_apart(from.path());
    let tree = open(&from.path().join("in parts.gltf"));
    let lod = one_gone_one_grown(&tree);
    let path = to.path().join("fewer leaves.gltf");
    let written = tree.write_lod(&lod, &path).unwrap();
    assert_eq!(
        file_names(to.path()),
        ["fewer leaves.bin", "fewer leaves.gltf", "textures"]
    );
    assert_eq!(
        fs::read(to.path().join("textures/leaf.png")).unwrap(),
        encodings::one_texel_png()
    );
    let sizes: u64 = written
        .files
        .iter()
        .map(|f| fs::metadata(f).unwrap().len())
        .sum();
    assert_eq!((written.files.len(), written.bytes), (3, sizes));
    // Two triangles of wood, two of each of three leaves.
    assert_eq!(written.triangles, 2 + 3 * 2);
    super::check::check_lod(&tree, &lod, &open(&path));

    // Beside the input there is nothing to copy; a GLB has no .bin.
    let beside = from.path().join("lod.glb");
    assert_eq!(
        tree.write_lod(&lod, &beside).unwrap().files,
        std::slice::from_ref(&beside)
    );
    super::check::check_lod(&tree, &lod, &open(&beside));
    assert_valid(&[path, beside]);
}

#[test]
fn an_image_does_not_replace_another() {
    let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write_apart(from.path());
    let tree = open(&from.path().join("in parts.gltf"));
    let lod = one_gone_one_grown(&tree);
    fs::create_dir(to.path().join("textures")).unwrap();
    fs::write(to.path().join("textures/leaf.png"), "another").unwrap();
    let error = tree
        .write_lod(&lod, &to.path().join("lod.glb"))
        .unwrap_err();
    assert!(
        matches!(error.problem(), Problem::Write(WriteProblem::Occupied(_))),
        "{error}"
    );
    assert_eq!(file_names(to.path()), ["textures"]);
    // The very same image may be there already.
    fs::write(
        to.path().join("textures/leaf.png"),
        encodings::one_texel_png(),
    )
    .unwrap();
    tree.write_lod(&lod, &to.path().join("lod.glb")).unwrap();
}

#[test]
fn the_input_is_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    write_apart(folder.path());
    let glb = folder.path().join("tree.glb");
    fs::write(&glb, encodings::rich().glb()).unwrap();
    let refuse = |tree: &Tree, path: &Path| {
        let before = fs::read(path).ok();
        let error = tree.write_lod(&one_gone_one_grown(tree), path).unwrap_err();
        assert!(
            matches!(error.problem(), Problem::Write(WriteProblem::IsInput)),
            "{error}"
        );
        assert_eq!(fs::read(path).ok(), before);
    };
    refuse(&open(&glb), &folder.path().join(".").join("tree.glb"));
    let apart = open(&folder.path().join("in parts.gltf"));
    refuse(&apart, &folder.path().join("in parts.gltf"));
    // Its .bin would go over the .bin of the input.
    fs::copy(
        folder.path().join("in parts.gltf"),
        folder.path().join("alias.gltf"),
    )
    .unwrap();
    let alias = open(&folder.path().join("alias.gltf"));
    refuse(&alias, &folder.path().join("in parts.gltf"));
}

#[test]
fn a_failure_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let tree = encodings::rich().tree();
    let lod = one_gone_one_grown(&tree);
    let fail = |name: &str, sentence: &str| {
        let error = tree
            .write_lod(&lod, &folder.path().join(name))
            .unwrap_err()
            .to_string();
        assert!(error.contains(sentence), "{error}");
    };
    fail("tree.obj", "must end in .glb or .gltf");
    fail("tree", "must end in .glb or .gltf");
    fail("no/such/tree.glb", "does not exist");
    // A folder is in the way of the file itself.
    fs::create_dir(folder.path().join("taken.gltf")).unwrap();
    fail("taken.gltf", "cannot be written");
    assert_eq!(
        file_names(&folder.path().join("taken.gltf")),
        [] as [&str; 0]
    );
    let left = file_names(folder.path());
    assert!(!left.iter().any(|name| name.ends_with(".tmp")), "{left:?}");
}

#[test]
fn a_glb_becomes_a_gltf() {
    let folder = tempfile::tempdir().unwrap();
    let tree = encodings::textured().tree();
    let lod = one_gone_one_grown(&tree);
    let path = folder.path().join("tree.gltf");
    tree.write_lod(&lod, &path).unwrap();
    let glb = read(tree.lod_to_bytes(&lod).unwrap());
    let gltf = open(&path);
    assert_eq!(gltf.foliage.triangles(), glb.foliage.triangles());
    assert_valid(&[path]);
}
