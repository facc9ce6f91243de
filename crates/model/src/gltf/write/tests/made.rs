//! Levels with leaves that the input has not.

use glam::DVec3;

use super::encodings;
use super::fixture::read;
use super::validator::assert_valid;
use crate::gltf::Tree;
use crate::{CornerRef, LeafId, Lod, NewCorner, NewLeaf, Place};

/// The first two leaves gone; in their place one that reaches from one to the
/// other, with the look of the second, and its last corner, unless it grows, where
/// none was.
fn one_of_two(tree: &Tree, area_scale: f64) -> (Lod, DVec3) {
    let leaf = |n| LeafId::new(n).unwrap();
    let mut lod = Lod::original(tree.foliage.leaves().len());
    lod.remove(leaf(1));
    lod.remove(leaf(2));
    let of = |n, corner, like| NewCorner {
        place: Place::Of(CornerRef {
            leaf: leaf(n),
            corner,
        }),
        like,
    };
    let apex = tree.foliage.leaf(leaf(1)).centre() + DVec3::new(0.25, 0.5, 0.75);
    let free = NewCorner {
        place: Place::At(apex),
        like: 2,
    };
    lod.make(NewLeaf {
        donor: leaf(2),
        triangles: vec![
            [of(1, 0, 0), of(2, 1, 1), free],
            [free, of(2, 1, 1), of(2, 2, 1)],
        ],
    });
    lod.resize(LeafId::from_index(tree.foliage.leaves().len()), area_scale);
    (lod, apex)
}

#[test]
fn a_new_leaf_has_its_places_and_the_look_of_its_donor() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    let all = || encodings::all().into_iter();
    let sizes = [1.0, 2.25].into_iter();
    for (area_scale, (name, fixture)) in sizes.flat_map(|s| all().map(move |e| (s, e))) {
        eprintln!("{name}, {area_scale} times as large");
        let tree = fixture.tree();
        let (lod, apex) = one_of_two(&tree, area_scale);
        let path = folder.path().join(format!("{name}-{area_scale}.glb"));
        let written = tree.write_lod(&lod, &path).unwrap();
        let after = read(std::fs::read(&path).unwrap());
        files.push(path);
        assert_eq!(written.triangles, after.triangle_count(), "{name}");
        assert_eq!(after.foliage.leaves().len(), lod.leaf_count(), "{name}");

        let expected = lod.foliage(&tree.foliage);
        let made = expected.triangles_of(LeafId::from_index(lod.leaf_count() - 1));
        if area_scale == 1.0 {
            assert_eq!(made[0].corners[2], apex);
        }
        let size = tree.foliage.bounding_sphere().unwrap();
        let tolerance = 1e-6 * (size.radius + size.centre.length());
        let is_made = |leaf: &LeafId| {
            let found = after.foliage.triangles_of(*leaf);
            let pairs = made.iter().zip(found);
            found.len() == made.len()
                && pairs.clone().all(|(m, f)| m.uvs == f.uvs)
                && pairs
                    .flat_map(|(m, f)| m.corners.into_iter().zip(f.corners))
                    .all(|(m, f)| m.distance(f) <= tolerance)
        };
        let leaves = (0..lod.leaf_count()).map(LeafId::from_index);
        assert_eq!(leaves.filter(is_made).count(), 1, "{name}");
    }
    assert_valid(&files);
}
