//! Simplify for the places from which a tree will really be seen: here a path
//! that passes it on one side, at eye level.
//!
//! `cargo run --release --example own_cameras`

use std::error::Error;

use secateur::glam::DVec3;
use secateur::plant::{EllipsoidCrown, ellipsoid_crown};
use secateur::{LeafId, Options, Resolution, Target, Views, simplify};
use secateur::{View, ViewError, ViewSet};

fn main() -> Result<(), Box<dyn Error>> {
    let foliage = ellipsoid_crown(2000, 1, &EllipsoidCrown::default())?;

    let eye_level_m = -3.0;
    let path = (-3..=3).map(|k| DVec3::new(3.0 * f64::from(k), eye_level_m, 12.0));
    let look = |eye| View::look_at(eye, DVec3::ZERO, DVec3::Y, View::TAN_30_DEGREES, 0.1);
    let views: Vec<View> = path.map(look).collect::<Result<_, ViewError>>()?;

    let mut options = Options::to(Target::leaf_share(0.2));
    options.views = Views::Cameras(ViewSet::new(views));
    options.resolution = Resolution::Pixels(128);
    let result = simplify(&foliage, &options)?;

    // What faces the path stays.
    let faces_path = |leaf: &LeafId| foliage.leaf(*leaf).centre().z > 0.0;
    let kept = result.lod.leaves().map(|(leaf, _)| leaf);
    let (near, far): (Vec<LeafId>, Vec<LeafId>) = kept.partition(faces_path);
    println!(
        "{} leaves stay on the path's side, {} on the other",
        near.len(),
        far.len()
    );
    Ok(())
}
