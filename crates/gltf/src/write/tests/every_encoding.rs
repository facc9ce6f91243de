//! What holds for every encoding.

use std::path::Path;

use super::check::check_lod;
use super::encodings;
use super::fixture::read;
use super::validator::assert_valid;
use crate::{Document, ImageFormat, Tree, WriteOptions};
use secateur_model::{LeafId, Lod};

/// The first leaf gone, the second of twice its area.
pub(super) fn one_gone_one_grown(tree: &Tree) -> Lod {
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(LeafId::new(1).unwrap());
    lod.resize(LeafId::new(2).unwrap(), 2.0);
    lod
}

fn without_leaves(tree: &Tree) -> Lod {
    let mut lod = Lod::original(tree.foliage.leaves().len());
    for index in 0..tree.foliage.leaves().len() {
        lod.remove(LeafId::from_index(index));
    }
    lod
}

fn written(tree: &Tree, lod: &Lod, path: &Path) -> Vec<u8> {
    tree.write_lod(lod, path).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn a_lod_differs_in_its_leaves_only() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for (name, fixture) in encodings::all() {
        eprintln!("{name}");
        let tree = fixture.tree();
        assert!(tree.foliage.leaves().len() >= 2, "{name}");
        let mut path = |kind: &str| {
            let path = folder.path().join(format!("{name}-{kind}.glb"));
            files.push(path.clone());
            path
        };
        std::fs::write(path("input"), fixture.glb()).unwrap();

        let lod = one_gone_one_grown(&tree);
        check_lod(&tree, &lod, &read(written(&tree, &lod, &path("lod"))));

        let same = Lod::original(tree.foliage.leaves().len());
        let copy = read(written(&tree, &same, &path("same")));
        check_lod(&tree, &same, &copy);
        let (before, after) = (&tree.document.root, &copy.document.root);
        assert_eq!(before["meshes"], after["meshes"], "{name}");
        assert_eq!(before["nodes"], after["nodes"], "{name}");

        let bare = written(&tree, &without_leaves(&tree), &path("bare"));
        let bare = Document::from_bytes("bare", bare, None).unwrap();
        assert!(
            bare.parts().unwrap().iter().all(|part| {
                bare.primitive(part.mesh, part.primitive).unwrap()["material"] == 0
            })
        );
    }
    assert_valid(&files);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    for (name, fixture) in encodings::all() {
        let lod = |tree: &Tree| tree.lod_to_bytes(&one_gone_one_grown(tree)).unwrap();
        assert_eq!(lod(&fixture.tree()), lod(&fixture.tree()), "{name}");
    }
}

#[test]
fn compressed_a_lod_is_the_same_within_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let many = ("many", encodings::plain(2000));
    for (name, fixture) in encodings::all().into_iter().chain([many]) {
        let tree = fixture.tree();
        let lod = one_gone_one_grown(&tree);
        let write = |kind: &str, compress: bool| {
            let path = folder.path().join(format!("{name}-{kind}.glb"));
            let options = WriteOptions::default().compress(compress.then(ImageFormat::default));
            let prepared = tree.prepare_lod(&lod, &path, options).unwrap();
            prepared.document().unwrap();
            (prepared.commit().unwrap(), path)
        };
        let (plain, _) = write("plain", false);
        let (small, path) = write("small", true);
        assert_eq!(small.triangles, plain.triangles, "{name}");
        let expected = lod.foliage(&tree.foliage);
        let found = read(std::fs::read(&path).unwrap());
        assert_eq!(found.foliage.leaves().len(), lod.leaf_count(), "{name}");
        if name == "many" {
            let (small, plain) = (small.bytes, plain.bytes);
            assert!(3 * small <= plain, "{small} bytes of {plain}");
            let far = expected.bounding_sphere().unwrap();
            let step = 2.0 * (far.radius + far.centre.length()) / 32768.0;
            let leaves = (0..lod.leaf_count()).map(LeafId::from_index);
            for leaf in leaves {
                let was = expected.triangles_of(leaf).iter();
                for (a, b) in was.zip(found.foliage.triangles_of(leaf)) {
                    let mut apart = b.corners.map(|b| {
                        let near = a.corners.map(|a| a.distance(b));
                        near.into_iter().fold(f64::INFINITY, f64::min)
                    });
                    apart.sort_by(f64::total_cmp);
                    assert!(apart[2] <= step, "{leaf}: {} m", apart[2]);
                }
            }
        }
        files.push(path);
    }
    assert_valid(&files);
}
