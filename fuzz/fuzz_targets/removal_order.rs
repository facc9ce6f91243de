//! Whatever the bytes behind its head, a removal order ends in levels that can be walked from the
//! finest to the coarsest and back, in a forest, or in an error. The head's counts are the input's,
//! its hash is that of the tree: else hardly any input would be read.

#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use secateur::glam::{DVec2, DVec3};
use secateur::{Foliage, LeafTriangle, Lod};
use secateur_runtime::order_file::{read_order, write_order};
use secateur_runtime::view_dependent::{Region, ViewDependent};

const LEAVES: usize = 24;

/// Squares of two triangles in rows of six.
fn foliage() -> &'static Foliage {
    static FOLIAGE: OnceLock<Foliage> = OnceLock::new();
    FOLIAGE.get_or_init(|| {
        let mut foliage = Foliage::default();
        for index in 0..LEAVES {
            let at = DVec3::new((index % 6) as f64, (index / 6) as f64, 0.1 * index as f64);
            let corner = |x: f64, y: f64| (at + 0.5 * DVec3::new(x, y, 0.0), DVec2::new(x, y));
            let triangle = |corners: [(DVec3, DVec2); 3]| LeafTriangle {
                corners: corners.map(|c| c.0),
                uvs: corners.map(|c| c.1),
            };
            let [a, b, c, d] = [
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(1.0, 1.0),
                corner(0.0, 1.0),
            ];
            let leaf = [triangle([a, b, c]), triangle([a, c, d])];
            foliage.push_leaf(&leaf, None).expect("a square");
        }
        foliage
    })
}

fuzz_target!(|bytes: &[u8]| {
    let foliage = foliage();
    let mut bytes = bytes.to_vec();
    if let Some(hash) = bytes.get_mut(16..48) {
        hash.copy_from_slice(&foliage.sha256());
    }
    let Ok(model) = read_order(&bytes, foliage) else {
        return;
    };
    let mut level = model.finest();
    level.go_to(model.order().len());
    let coarsest = level.lod();
    assert_eq!(coarsest, Lod::after(model.order(), model.order().len()));
    let _ = coarsest.foliage(foliage);
    level.go_to(0);
    assert_eq!(level.lod(), Lod::original(LEAVES));
    assert_eq!(
        read_order(&write_order(&model, foliage), foliage).as_ref(),
        Ok(&model)
    );
    let mut parts = ViewDependent::new(&model, foliage);
    parts.refine(&mut |_: &Region| false);
    let _ = parts.lod(&model).foliage(foliage);
    parts.refine(&mut |_: &Region| true);
});
