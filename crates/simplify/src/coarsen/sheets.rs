//! Bent or folded leaves with a texture, each as one flat triangle.
//!
//! A leaf folded along its midrib is no card, but its texture still lies over it in one piece. Three
//! of its corners say how that texture lies in a plane, and the triangle around what the texture
//! shows is put into that plane. What is lost is the fold, which from most sides hardly shows; with
//! two triangles at least, half as many leaves would be left.

use glam::{DVec2, DVec3};
use secateur_model::{Foliage, LeafId, LeafTriangle, NewCorner, NewLeaf, Place};

use super::card_textures::CardTextures;
use super::cards::{Cards, MAX_TRIANGLES};
use super::enclosing_triangle::Weights;
use super::leaf_mesh;
use super::triangle::{CornerTriple, facing};

/// For each leaf that is a sheet, the texture coordinates of a triangle around all that it shows.
#[derive(Debug)]
pub(super) struct Sheets(Vec<Option<[DVec2; 3]>>);

impl Sheets {
    /// Finds the leaves that are sheets and no flat cards.
    pub(super) fn of(foliage: &Foliage, cards: &Cards) -> Self {
        let mut textures = CardTextures::of(foliage);
        let leaves = (0..foliage.leaves().len()).map(LeafId::from_index);
        let numbers: Vec<Option<usize>> = leaves
            .clone()
            .map(|leaf| {
                let cutout = foliage.leaf(leaf).cutout()?;
                let triangles = foliage.triangles_of(leaf);
                let may_be = cards.triangles_of(leaf).is_none() && is_sheet(triangles);
                may_be.then(|| textures.number(cutout, uvs_of(triangles)))?
            })
            .collect();
        let found = textures.enclosing_triangles();
        let of_leaf = |(leaf, number): (LeafId, &Option<usize>)| {
            let first = foliage.triangles_of(leaf)[0].uvs;
            let corners = found[(*number)?].as_ref()?;
            Some([0, 1, 2].map(|k| corners[k].at(&first)))
        };
        Self(leaves.zip(&numbers).map(of_leaf).collect())
    }

    /// Whether a leaf is a sheet that a triangle of its texture shows all of.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub(super) fn has(&self, leaf: LeafId) -> bool {
        self.0[leaf.index()].is_some()
    }

    /// A sheet flat in the plane of three of its corners, as one triangle with all of its texture;
    /// none if that plane faces away from where the leaf does, or the three are no triangle of the
    /// texture.
    pub(super) fn flat(
        &self,
        foliage: &Foliage,
        leaf: LeafId,
        plane: CornerTriple,
    ) -> Option<NewLeaf> {
        let around = self.0[leaf.index()]?;
        let triangles = foliage.triangles_of(leaf);
        let corner = |corner: u32| {
            let triangle = &triangles[corner as usize / 3];
            let k = corner as usize % 3;
            (triangle.corners[k], triangle.uvs[k])
        };
        let uvs = plane.map(|c| corner(c).1);
        let weights = around.map(|uv| Weights::of(&uvs, uv));
        if !weights.iter().flat_map(|w| w.0).all(f64::is_finite) {
            return None;
        }
        let [a, b, c] = weights.map(|weights| {
            let pairs = weights.0.into_iter().zip(plane);
            pairs.map(|(weight, c)| weight * corner(c).0).sum::<DVec3>()
        });
        if (b - a).cross(c - a).dot(facing(triangles)) <= 0.0 {
            return None;
        }
        let like = |uv: DVec2| {
            let distance = |c: &u32| corner(*c).1.distance_squared(uv);
            let all = 0..3 * triangles.len() as u32;
            all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .expect("a leaf has corners")
        };
        let new = |k: usize| NewCorner {
            place: Place::InPlaneOf {
                corners: plane,
                weights: weights[k].0,
            },
            like: like(around[k]),
        };
        Some(NewLeaf {
            donor: leaf,
            triangles: vec![[0, 1, 2].map(new)],
        })
    }
}

fn uvs_of(triangles: &[LeafTriangle]) -> Vec<[DVec2; 3]> {
    triangles.iter().map(|triangle| triangle.uvs).collect()
}

/// Whether triangles hang together, and the texture lies over all of them with the same side up.
fn is_sheet(triangles: &[LeafTriangle]) -> bool {
    if !(2..=MAX_TRIANGLES).contains(&triangles.len()) {
        return false;
    }
    let turn = |t: &LeafTriangle| (t.uvs[1] - t.uvs[0]).perp_dot(t.uvs[2] - t.uvs[0]);
    let side = turn(&triangles[0]);
    triangles.iter().all(|t| side * turn(t) > 0.0) && hangs_together(triangles)
}

/// Whether one gets from each triangle to each other over corners that share place and texture.
fn hangs_together(triangles: &[LeafTriangle]) -> bool {
    let Some(vertices) = leaf_mesh::vertices(triangles) else {
        return false;
    };
    let mut is_reached = vec![false; triangles.len()];
    is_reached[0] = true;
    loop {
        let of = |t: usize| &vertices[3 * t..3 * t + 3];
        let touches = |t: usize| {
            let reached = (0..triangles.len()).filter(|other| is_reached[*other]);
            let mut shared = reached.flat_map(of);
            shared.any(|vertex| of(t).contains(vertex))
        };
        let next = (0..triangles.len()).find(|t| !is_reached[*t] && touches(*t));
        match next {
            Some(next) => is_reached[next] = true,
            None => return is_reached.iter().all(|is| *is),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use secateur_model::{Cutout, Wrap};

    use super::*;
    use crate::coarsen::{LossCurves, coarsen, share_triangles};

    /// A disc in the middle of an otherwise empty texture.
    fn disc() -> Arc<Cutout> {
        let is_in = |x: u32, y: u32| {
            let at = DVec2::new(f64::from(x) - 31.5, f64::from(y) - 31.5);
            at.length() < 24.0
        };
        Arc::new(Cutout::from_fn([64, 64], [Wrap::ClampToEdge; 2], is_in))
    }

    /// A leaf of 2 by 2 about a place, folded along its middle: each half is `slope` times as deep
    /// as wide. Its texture lies over it once.
    fn folded(at: DVec3, slope: f64) -> Vec<LeafTriangle> {
        let place = |u: f64, v: f64| {
            let x = 2.0 * u - 1.0;
            (
                at + DVec3::new(x, 2.0 * v - 1.0, slope * x.abs()),
                DVec2::new(u, v),
            )
        };
        let quad = |u: f64| [(u, 0.0), (u + 0.5, 0.0), (u + 0.5, 1.0), (u, 1.0)];
        let triangles = |corners: [(f64, f64); 4]| {
            [[0, 1, 2], [0, 2, 3]].map(|t| {
                let corners = t.map(|k| place(corners[k].0, corners[k].1));
                LeafTriangle {
                    corners: corners.map(|c| c.0),
                    uvs: corners.map(|c| c.1),
                }
            })
        };
        [triangles(quad(0.0)), triangles(quad(0.5))].concat()
    }

    fn of(leaves: &[Vec<LeafTriangle>]) -> Foliage {
        let mut foliage = Foliage::new(vec![disc()]);
        for leaf in leaves {
            foliage.push_leaf(leaf, Some(0)).unwrap();
        }
        foliage
    }

    fn is_found(leaf: Vec<LeafTriangle>) -> bool {
        let foliage = of(&[leaf]);
        Sheets::of(&foliage, &Cards::of(&foliage)).has(LeafId::from_index(0))
    }

    #[test]
    fn a_folded_leaf_is_a_triangle_with_all_of_its_texture() {
        let leaves: Vec<_> = (0..9)
            .map(|k| folded(DVec3::new(4.0 * f64::from(k), 0.0, f64::from(k % 3)), 0.3))
            .collect();
        let foliage = of(&leaves);
        let curves = LossCurves::of(&foliage);
        let least = curves.hull(LeafId::from_index(0))[0];
        assert_eq!(least.triangles, 1);
        assert!(least.loss < 0.3, "{}", least.loss);
        let shares = share_triangles(&foliage, 9, &curves);
        assert_eq!(shares, [1; 9]);
        let coarse = coarsen(&foliage, &curves, &shares).unwrap();
        for index in 0..9 {
            let leaf = LeafId::from_index(index);
            let [one] = coarse.foliage().triangles_of(leaf) else {
                panic!("one triangle");
            };
            // All of the disc is within it.
            for k in 0..16 {
                let on_rim = DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 16.0);
                let weights = Weights::of(&one.uvs, DVec2::splat(0.5) + 0.37 * on_rim);
                assert!(weights.0.iter().all(|weight| *weight > 0.0));
            }
            // The sheet faces where the leaf does, and its texture lies as large as it did.
            let [a, b, c] = one.corners;
            let area = 0.5 * (b - a).cross(c - a);
            assert!(area.z > 0.9 * area.length());
            let [a, b, c] = one.uvs;
            let of_texture = 0.5 * (b - a).perp_dot(c - a);
            assert!((3.5..4.5).contains(&(area.length() / of_texture)));
        }
    }

    #[test]
    fn what_has_no_one_sheet_is_none() {
        let at = DVec3::new(1.0, 2.0, 3.0);
        let leaf = folded(at, 0.5);
        assert!(is_found(leaf.clone()));
        assert!(!is_found(leaf[..1].to_vec()), "a triangle");
        assert!(!is_found(folded(at, 0.0)), "a flat card");
        // A bent card beside another, which shows the same texture.
        let two = [leaf.clone(), folded(at + DVec3::Y * 9.0, 0.5)].concat();
        assert!(!is_found(two), "two sheets");
        let mut mirrored = leaf.clone();
        for triangle in &mut mirrored[2..] {
            for uv in &mut triangle.uvs {
                uv.x = 1.0 - uv.x;
            }
        }
        assert!(!is_found(mirrored), "a texture that turns back at the fold");
        let mut plain = Foliage::default();
        plain.push_leaf(&leaf, None).unwrap();
        let sheets = Sheets::of(&plain, &Cards::of(&plain));
        assert!(!sheets.has(LeafId::from_index(0)), "without a texture");
    }

    #[test]
    fn a_plane_that_faces_away_is_none() {
        // The right half, half as wide, is turned back over the left one and faces down.
        let mut leaf = folded(DVec3::ZERO, 0.2);
        for triangle in &mut leaf[2..] {
            for at in &mut triangle.corners {
                at.x *= -0.5;
            }
        }
        let foliage = of(&[leaf]);
        let sheets = Sheets::of(&foliage, &Cards::of(&foliage));
        let flat = |plane| sheets.flat(&foliage, LeafId::from_index(0), plane);
        assert!(flat([0, 1, 2]).is_some(), "the left half");
        assert!(flat([6, 7, 8]).is_none(), "the right half");
        assert!(flat([1, 2, 6]).is_none(), "three on the fold");
    }
}
