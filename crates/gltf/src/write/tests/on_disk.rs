//! Files: beside each other, all or none.

use std::fs;
use std::path::Path;

use super::encodings;
use super::every_encoding::one_gone_one_grown;
use super::fixture::{Fixture, read};
use super::validator::assert_valid;
use crate::{Document, Problem, Selector, Tree, WriteOptions, WriteProblem};
use secateur_model::{LeafId, Lod};

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

#[test]
fn a_buffer_does_not_replace_a_file_of_somebody_else() {
    let folder = tempfile::tempdir().unwrap();
    let tree = encodings::rich().tree();
    let lod = one_gone_one_grown(&tree);
    let [gltf, bin] = ["o.gltf", "o.bin"].map(|name| folder.path().join(name));
    let is_refused = || {
        let error = tree.write_lod(&lod, &gltf).unwrap_err();
        let checked = WriteOptions::default().check(&gltf).unwrap_err();
        for error in [error, checked] {
            let problem = error.problem();
            let is_it = matches!(problem, Problem::Write(WriteProblem::UnrelatedBuffer(_)));
            assert!(is_it, "{error}");
        }
        assert_eq!(fs::read(&bin).unwrap(), b"mine");
    };
    fs::write(&bin, "mine").unwrap();
    is_refused();
    // A .gltf that names another buffer, and one that is none.
    let another =
        r#"{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "p.bin"}]}"#;
    for there in [another, "no glTF"] {
        fs::write(&gltf, there).unwrap();
        is_refused();
        assert_eq!(fs::read_to_string(&gltf).unwrap(), there);
    }

    let overwrite = WriteOptions::default().overwrite(true);
    let prepared = tree.prepare_lod(&lod, &gltf, overwrite).unwrap();
    prepared.commit().unwrap();
    super::check::check_lod(&tree, &lod, &open(&gltf));
    // From now on it is the buffer of that .gltf.
    tree.write_lod(&Lod::original(tree.foliage.leaves().len()), &gltf)
        .unwrap();
    assert_eq!(file_names(folder.path()), ["o.bin", "o.gltf"]);
}

/// A program can be killed between any two of the names that it gives. Whenever that is,
/// the .gltf in the folder is the old tree or the new one, and the next run cleans up.
#[test]
fn a_kill_leaves_the_old_tree_or_the_new_one() {
    let tree = encodings::rich().tree();
    let old = Lod::original(tree.foliage.leaves().len());
    let new = one_gone_one_grown(&tree);
    let triangles = |lod: &Lod| {
        read(tree.lod_to_bytes(lod).unwrap())
            .foliage
            .triangles()
            .to_vec()
    };
    let [old_triangles, new_triangles] = [&old, &new].map(triangles);
    assert_ne!(old_triangles, new_triangles);
    let mut seen = Vec::new();
    for steps in 0.. {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("o.gltf");
        tree.write_lod(&old, &path).unwrap();
        let prepared = tree.prepare_lod(&new, &path, WriteOptions::default());
        let was_killed = prepared.unwrap().into_files().1.be_killed_after(steps);
        let there = open(&path).foliage.triangles().to_vec();
        assert!(
            there == old_triangles || there == new_triangles,
            "after {steps} steps"
        );
        seen.push(there == new_triangles);
        let json = fs::read_to_string(&path).unwrap();
        let is_stranded = file_names(folder.path()).contains(&"o.secateur-1.bin".to_owned())
            && !json.contains("o.secateur-1.bin");

        // The next run is of a third tree, so that its buffer is another one again.
        let mut third = old.clone();
        third.remove(LeafId::from_index(1));
        tree.write_lod(&third, &path).unwrap();
        let left = file_names(folder.path());
        // A buffer that the .gltf of then did not name stays: it could be anybody's.
        let expected = ["o.bin", "o.gltf", "o.secateur-1.bin"];
        assert_eq!(left, expected[..2 + usize::from(is_stranded)], "{steps}");
        super::check::check_lod(&tree, &third, &open(&path));
        if !was_killed {
            break;
        }
    }
    assert!(seen.is_sorted() && seen.last() == Some(&true), "{seen:?}");
}

#[test]
fn a_prepared_tree_can_be_looked_at_before_it_has_its_name() {
    let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write_apart(from.path());
    let tree = open(&from.path().join("in parts.gltf"));
    let lod = one_gone_one_grown(&tree);
    for name in ["o.gltf", "o.glb"] {
        let path = to.path().join(name);
        let prepared = tree
            .prepare_lod(&lod, &path, WriteOptions::default())
            .unwrap();
        assert!(!path.exists());
        let looked_at = prepared.document().unwrap().surfaces(&[]).unwrap();
        let written = prepared.commit().unwrap();
        assert_eq!(written.files[0], path);
        assert!(written.files.iter().all(|file| file.exists()));
        assert_eq!(
            looked_at,
            Document::open(&path).unwrap().surfaces(&[]).unwrap()
        );
        assert!(
            looked_at
                .iter()
                .any(|(surface, _)| surface.material.texture.is_some())
        );
    }
    // Nothing is left of one that is dropped, not even the folder of its image.
    let dropped = tempfile::tempdir().unwrap();
    let path = dropped.path().join("o.gltf");
    drop(
        tree.prepare_lod(&lod, &path, WriteOptions::default())
            .unwrap(),
    );
    assert_eq!(file_names(dropped.path()), [] as [&str; 0]);
}
