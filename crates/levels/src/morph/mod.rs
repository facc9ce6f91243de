//! How a level becomes the next one while a camera goes away: where each of its corners is when the next takes over.
//!
//! A leaf that stays becomes the leaf of the next level: each corner goes to where that shows the same of the texture,
//! or to the nearest place of it. A leaf that goes shrinks to its centre. Wood goes to the nearest place of what is left
//! of its piece; what is gone of a piece draws back along the piece, and a piece that is gone to where it grows on.

mod by_position;
mod by_texture;
mod surface;

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;
use secateur_gltf::WholeTree;
use secateur_gltf::chain::Morph;
use secateur_model::{Foliage, LeafId, LeafTriangle, Lod, centroid_of};

use by_position::{drawn_back, moved_onto};
use by_texture::{is_textured, moved_along_texture};
use surface::Surface;

/// A leaf or a piece of wood of a level.
struct Form<'a> {
    /// Its triangles before they were scaled.
    triangles: Cow<'a, [LeafTriangle]>,
    /// What they are scaled about, by this linear factor.
    centre: DVec3,
    linear_scale: f64,
}

impl Form<'_> {
    /// Where a point of the unscaled triangles is.
    fn placed(&self, point: DVec3) -> DVec3 {
        match self.linear_scale == 1.0 {
            true => point,
            false => self.centre + self.linear_scale * (point - self.centre),
        }
    }
}

/// The original item that a form is of, and the form.
type FormOf<'a> = (LeafId, Form<'a>);

/// The leaves and pieces of wood of a level: originals, and made ones in their order.
fn forms<'a>(items: &'a Foliage, lod: &Lod) -> [Vec<FormOf<'a>>; 2] {
    let originals = lod.leaves().map(|(leaf, area_scale)| {
        let form = Form {
            triangles: Cow::Borrowed(items.triangles_of(leaf)),
            centre: items.leaf(leaf).centre(),
            linear_scale: area_scale.sqrt(),
        };
        (leaf, form)
    });
    let made = lod.made().map(|(made, area_scale)| {
        let triangles = made.triangles_in(items, 1.0);
        let form = Form {
            centre: centroid_of(&triangles),
            triangles: Cow::Owned(triangles),
            linear_scale: area_scale.sqrt(),
        };
        (made.donor, form)
    });
    [originals.collect(), made.collect()]
}

/// What a level becomes.
struct Next<'a> {
    items: &'a Foliage,
    first_of_wood: usize,
    /// By item, what is left of it.
    forms: Vec<Vec<Form<'a>>>,
    /// All of its wood.
    wood: Surface,
}

impl<'a> Next<'a> {
    fn of(items: &'a Foliage, lod: &Lod, first_of_wood: usize) -> Self {
        let mut by_item: Vec<Vec<Form<'a>>> = Vec::new();
        by_item.resize_with(items.leaves().len(), Vec::new);
        let [originals, made] = forms(items, lod);
        for (item, form) in originals.into_iter().chain(made) {
            by_item[item.index()].push(form);
        }
        let wood = by_item[first_of_wood..].iter().flatten();
        Self {
            wood: Surface::of(wood),
            items,
            first_of_wood,
            forms: by_item,
        }
    }

    /// Where the triangles of a leaf or a piece of wood go.
    fn places(&self, item: LeafId, form: &Form<'_>) -> Vec<[DVec3; 3]> {
        let left = &self.forms[item.index()][..];
        let is_wood = item.index() >= self.first_of_wood;
        match left {
            [] if is_wood => drawn_back(form, &self.wood),
            [] => vec![[form.centre; 3]; form.triangles.len()],
            [only] if only.triangles == form.triangles => {
                let triangles = form.triangles.iter();
                triangles
                    .map(|t| t.corners.map(|corner| only.placed(corner)))
                    .collect()
            }
            left if !is_wood && is_textured(left) => {
                let is_cut_out = self.items.leaf(item).cutout().is_some();
                moved_along_texture(form, left, is_cut_out)
            }
            left => moved_onto(form, left),
        }
    }
}

/// Where the corners of a level of the tree's items are when the next one takes over.
pub(crate) fn morph(tree: &WholeTree, lod: &Lod, next: &Lod) -> Morph {
    let items = tree.items().foliage();
    let next = Next::of(items, next, tree.leaves().leaves().len());
    let [left, made] = forms(items, lod);
    let places = |(item, form): &FormOf<'_>| next.places(*item, form);
    let mut originals = vec![Vec::new(); items.leaves().len()];
    let of_left: Vec<Vec<[DVec3; 3]>> = left.par_iter().map(places).collect();
    for ((item, _), places) in left.iter().zip(of_left) {
        originals[item.index()] = places;
    }
    Morph {
        originals,
        made: made.par_iter().map(places).collect(),
    }
}

#[cfg(test)]
mod tests;
