//! Skeletons of grown plants, there and back.

use glam::DVec3;
use serde_json::{Value, json};

use super::fixture::read;
use super::grown::plant;
use super::validator::assert_valid;
use crate::{Document, GltfError, Selector, Tree, plant_to_glb};
use secateur_model::{
    LeafId, Lod, NewCorner, NewLeaf, Place, Plant, PlantSkeleton, RemovalOrder, Segment,
    SegmentIndex, Step,
};

/// A stem of two segments with a twig on the first; leaf k grows on segment
/// k % 4, where 3 stands for none.
fn with_skeleton(leaves: usize) -> Plant {
    let segment = |parent: Option<usize>, end: DVec3| Segment {
        parent: parent.map(SegmentIndex::from_index),
        continues_parent: parent == Some(0) && end.x == 0.0,
        start: DVec3::Y * 0.5,
        end,
        start_radius_m: 0.25,
        end_radius_m: 0.125,
        sides: 7,
    };
    let segments = vec![
        segment(None, DVec3::Y),
        segment(Some(0), DVec3::Y * 2.0),
        segment(Some(0), DVec3::new(1.0, 1.5, 0.0)),
    ];
    let on = |leaf: usize| Some(leaf % 4).filter(|s| *s < 3);
    Plant {
        skeleton: Some(PlantSkeleton {
            segments,
            leaf_segments: (0..leaves)
                .map(|leaf| on(leaf).map(SegmentIndex::from_index))
                .collect(),
        }),
        ..plant(leaves)
    }
}

fn tree(glb: Vec<u8>) -> Tree {
    let leaves = [Selector::Material("leaf".to_owned())];
    let document = Document::from_bytes("larch.glb", glb, None).unwrap();
    document.into_tree(&leaves).unwrap()
}

#[test]
fn a_skeleton_is_read_as_it_was_written() {
    let plant = with_skeleton(6);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("larch.glb");
    std::fs::write(&path, plant_to_glb(&plant)).unwrap();
    assert_valid(&[path]);
    assert_eq!(
        tree(plant_to_glb(&plant)).skeleton().unwrap(),
        plant.skeleton
    );
    let bare = tree(plant_to_glb(&super::grown::plant(6)));
    assert_eq!(bare.skeleton().unwrap(), None);
    let says = |plant| Document::from_bytes("larch.glb", plant_to_glb(plant), None);
    assert!(says(&plant).unwrap().has_skeleton());
    assert!(!says(&super::grown::plant(6)).unwrap().has_skeleton());
}

#[test]
fn leaves_that_are_left_still_know_their_segments() {
    let tree = tree(plant_to_glb(&with_skeleton(6)));
    let leaf = |n| LeafId::new(n).unwrap();
    let mut lod = Lod::original(6);
    lod.remove(leaf(1));
    lod.remove(leaf(4));
    lod.resize(leaf(2), 2.0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("larch-4.glb");
    tree.write_lod(&lod, &path).unwrap();
    let left = read(std::fs::read(&path).unwrap());
    assert_valid(&[path]);
    let skeleton = left.skeleton().unwrap().unwrap();
    // Of segments 0, 1, 2, none, 0, 1 the first and the fourth are gone.
    let places = [Some(1), Some(2), Some(0), Some(1)];
    assert_eq!(
        skeleton.leaf_segments,
        places.map(|s| s.map(SegmentIndex::from_index))
    );
    assert_eq!(
        skeleton.segments,
        with_skeleton(6).skeleton.unwrap().segments
    );
}

/// A leaf that was made stands where its donor stood, and comes last.
#[test]
fn made_leaves_grow_where_their_donors_did() {
    let tree = tree(plant_to_glb(&with_skeleton(6)));
    let leaf = |n| LeafId::new(n).unwrap();
    let corner = |like: u32| NewCorner {
        place: Place::At(DVec3::new(9.0 + f64::from(like), f64::from(like % 2), 0.0)),
        like,
    };
    let mut order = RemovalOrder::new(6);
    order.push_step(Step {
        removed: &[leaf(1), leaf(2)],
        grown: &[],
        made: &[NewLeaf {
            donor: leaf(2),
            triangles: vec![[0, 1, 2].map(corner)],
        }],
        survivors_area_scale: 1.0,
    });
    let left = read(tree.lod_to_bytes(&Lod::after(&order, 1)).unwrap());
    let skeleton = left.skeleton().unwrap().unwrap();
    // Of segments 0, 1, 2, none, 0, 1 the first two are gone, and the second is back.
    let places = [Some(2), None, Some(0), Some(1), Some(1)];
    assert_eq!(
        skeleton.leaf_segments,
        places.map(|s| s.map(SegmentIndex::from_index))
    );
}

/// Without leaves there is no list of them, and an empty one is no accessor.
#[test]
fn without_leaves_there_is_no_skeleton() {
    let tree = tree(plant_to_glb(&with_skeleton(2)));
    let mut lod = Lod::original(2);
    lod.remove(LeafId::new(1).unwrap());
    lod.remove(LeafId::new(2).unwrap());
    let bytes = tree.lod_to_bytes(&lod).unwrap();
    let left = Document::from_bytes("larch-0.glb", bytes, None).unwrap();
    assert!(!left.has_skeleton());
}

/// The file of [`with_skeleton`] with its JSON changed.
fn broken(change: impl FnOnce(&mut Value)) -> Result<Option<PlantSkeleton>, GltfError> {
    let mut tree = tree(plant_to_glb(&with_skeleton(6)));
    change(&mut tree.document.root);
    tree.skeleton()
}

#[test]
fn what_is_no_skeleton_is_said_in_a_sentence() {
    let at = |name: &str| format!("/extras/secateur_skeleton/accessors/{name}");
    let number = |root: &Value, name: &str| root.pointer(&at(name)).unwrap().clone();
    let said = |change: &dyn Fn(&mut Value)| broken(change).unwrap_err().to_string();
    let place = "larch.glb: extras.secateur_skeleton";
    assert_eq!(
        said(&|root| root["extras"]["secateur_skeleton"]["version"] = json!(2)),
        format!("{place}: `version` is 2, not 1")
    );
    assert_eq!(
        said(&|root| *root.pointer_mut(&at("leaf_segment")).unwrap() = json!(99)),
        "larch.glb: `accessors[99]` does not exist: there are 17"
    );
    assert_eq!(
        said(&|root| root["extras"]["secateur_skeleton"] = json!({"version": 1})),
        format!("{place}.accessors: has no `segment_parent`")
    );
    assert_eq!(
        said(&|root| {
            *root.pointer_mut(&at("segment_parent")).unwrap() = number(root, "segment_start");
        }),
        "larch.glb: accessors[13]: is VEC3 of FLOAT, which cannot be used as segment_parent"
    );
    assert_eq!(
        said(&|root| {
            *root.pointer_mut(&at("segment_parent")).unwrap() = number(root, "leaf_segment");
        }),
        format!("{place}: segment_continues has 3 elements where segment_parent has 6")
    );
    assert_eq!(
        said(&|root| {
            *root.pointer_mut(&at("segment_sides")).unwrap() = number(root, "segment_continues");
        }),
        format!("{place}: segment 0 of the skeleton has a number out of range")
    );
    assert_eq!(
        said(&|root| {
            *root.pointer_mut(&at("leaf_segment")).unwrap() = number(root, "segment_parent");
        }),
        format!("{place}: the skeleton knows 3 leaves where the foliage has 6")
    );
}

#[test]
fn segments_grow_from_what_is_before_them() {
    let mut skeleton = with_skeleton(6).skeleton.unwrap();
    skeleton.check(6).unwrap();
    skeleton.leaf_segments[5] = Some(SegmentIndex::from_index(3));
    let stray = skeleton.check(6).unwrap_err().to_string();
    assert_eq!(stray, "leaf 5 of the skeleton grows on segment 3, of 3");
    skeleton.segments[1].parent = Some(SegmentIndex::from_index(1));
    let own = skeleton.check(6).unwrap_err().to_string();
    assert_eq!(
        own,
        "segment 1 of the skeleton grows from one that is not before it"
    );
}
