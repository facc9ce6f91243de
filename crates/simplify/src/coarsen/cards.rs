//! Flat cards, each as one triangle that shows the same.
//!
//! A card has two triangles because its texture is a square. To be seen is what alpha
//! leaves of it, and one triangle around that shows all of it, where the texture is
//! empty beyond the card: where its border is, and goes on, or where it repeats far
//! enough away.

use rayon::prelude::*;
use secateur_model::{CornerRef, Foliage, LeafId, LeafTriangle, NewCorner, Place};

use super::card_textures::CardTextures;
use super::enclosing_triangle::Weights;

/// Largest number of triangles of a leaf that is looked at for cards.
pub(super) const MAX_TRIANGLES: usize = 64;

/// Corners may be off a card's plane, or off the place that the texture gives them, by at most
/// this part of its longest edge.
const FLATNESS: f64 = 0.02;

/// For each leaf the triangles that show the same as all of it, where they are fewer.
#[derive(Debug)]
pub(super) struct Cards(Vec<Option<Vec<[NewCorner; 3]>>>);

/// Triangles of a leaf in one plane, over which the texture lies without a fold; the first
/// of them has an area.
type Card = Vec<usize>;

impl Cards {
    /// Finds the cards of all leaves, on the threads of the current rayon pool.
    pub(super) fn of(foliage: &Foliage) -> Self {
        let leaves = (0..foliage.leaves().len()).into_par_iter();
        let cards: Vec<Vec<Card>> = leaves
            .map(|index| cards_of(foliage, LeafId::from_index(index)))
            .collect();
        let mut textures = CardTextures::of(foliage);
        let mut number = |leaf: LeafId, card: &Card| {
            if card.len() == 1 {
                return None;
            }
            let of_leaf = foliage.triangles_of(leaf);
            let cutout = foliage.leaf(leaf).cutout()?;
            textures.number(cutout, card.iter().map(|t| of_leaf[*t].uvs).collect())
        };
        let numbers: Vec<Vec<Option<usize>>> = cards
            .iter()
            .enumerate()
            .map(|(index, cards)| {
                let of = |card| number(LeafId::from_index(index), card);
                cards.iter().map(of).collect()
            })
            .collect();
        let found = textures.enclosing_triangles();
        let of_leaf = |(index, cards): (usize, &Vec<Card>)| {
            let leaf = LeafId::from_index(index);
            let pairs = cards.iter().zip(&numbers[index]);
            let triangle = |(card, number): (&Card, &Option<usize>)| match card[..] {
                [only] => Some(as_it_is(leaf, only)),
                _ => Some(placed(foliage.triangles_of(leaf), card, found[(*number)?]?)),
            };
            if cards.is_empty() {
                return None;
            }
            pairs.map(triangle).collect::<Option<Vec<_>>>()
        };
        Self(cards.iter().enumerate().map(of_leaf).collect())
    }

    /// The triangles that show all of a leaf, where they are fewer than it has.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub(super) fn triangles_of(&self, leaf: LeafId) -> Option<&[[NewCorner; 3]]> {
        self.0[leaf.index()].as_deref()
    }
}

/// The cards that a leaf consists of; none where they are no fewer than its triangles.
fn cards_of(foliage: &Foliage, leaf: LeafId) -> Vec<Card> {
    let triangles = foliage.triangles_of(leaf);
    if foliage.leaf(leaf).cutout().is_none() || !(2..=MAX_TRIANGLES).contains(&triangles.len()) {
        return Vec::new();
    }
    let mut cards: Vec<Card> = Vec::new();
    for (number, triangle) in triangles.iter().enumerate() {
        let goes_on = |card: &&mut Card| continues(&triangles[card[0]], triangle);
        match cards.iter_mut().find(goes_on) {
            Some(card) => card.push(number),
            None => cards.push(vec![number]),
        }
    }
    if cards.len() == triangles.len() {
        cards.clear();
    }
    cards
}

/// Whether the second lies in the plane of the first and its texture goes on there, on the
/// same side.
fn continues(first: &LeafTriangle, second: &LeafTriangle) -> bool {
    let [a, b, c] = first.corners;
    let longest = (a - b).length().max((b - c).length()).max((c - a).length());
    let is_at_place = |k: usize| {
        let [x, y, z] = Weights::of(&first.uvs, second.uvs[k]).0;
        let there = x * a + y * b + z * c;
        there.distance(second.corners[k]) <= FLATNESS * longest
    };
    let turn = |uvs: [glam::DVec2; 3]| (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]);
    turn(first.uvs) * turn(second.uvs) > 0.0 && (0..3).all(is_at_place)
}

fn as_it_is(leaf: LeafId, triangle: usize) -> [NewCorner; 3] {
    [0, 1, 2].map(|k| {
        let corner = 3 * triangle as u32 + k;
        NewCorner {
            place: Place::Of(CornerRef { leaf, corner }),
            like: corner,
        }
    })
}

/// A triangle in the plane of a card, each corner like the one of the card that is nearest
/// in the texture.
fn placed(triangles: &[LeafTriangle], card: &Card, corners: [Weights; 3]) -> [NewCorner; 3] {
    let uvs = triangles[card[0]].uvs;
    let all = || card.iter().flat_map(|&t| (0..3).map(move |k| (t, k)));
    corners.map(|weights| {
        let uv = weights.at(&uvs);
        let distance = |(t, k): &(usize, usize)| triangles[*t].uvs[*k].distance_squared(uv);
        let nearest = all().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let (triangle, corner) = nearest.expect("a card has triangles");
        NewCorner {
            place: Place::InPlaneOf {
                corners: [0, 1, 2].map(|k| 3 * card[0] as u32 + k),
                weights: weights.0,
            },
            like: (3 * triangle + corner) as u32,
        }
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DQuat, DVec2, DVec3};
    use secateur_model::{Cutout, NewLeaf, Wrap};

    use super::super::card_textures::MAX_CARD_TEXTURES;
    use super::*;
    use crate::coarsen::{LossCurves, coarsen};

    /// A disc in the middle of an otherwise empty texture.
    fn disc() -> Arc<Cutout> {
        let is_in = |x: u32, y: u32| {
            let at = DVec2::new(f64::from(x) - 31.5, f64::from(y) - 31.5);
            at.length() < 24.0
        };
        Arc::new(Cutout::from_fn([64, 64], [Wrap::ClampToEdge; 2], is_in))
    }

    /// A card of 3 by 2 about a place, turned and bent along its diagonal.
    fn card(at: DVec3, bend: f64) -> Vec<LeafTriangle> {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, at.x, at.z);
        let corners = [
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (1.0, 1.0, bend),
            (0.0, 1.0, 0.0),
        ];
        let place = |k: usize| {
            let (u, v, up) = corners[k];
            let flat = DVec3::new(3.0 * u - 1.5, 2.0 * v - 1.0, up);
            (at + turn * flat, DVec2::new(u, v))
        };
        let triangle = |t: [usize; 3]| LeafTriangle {
            corners: t.map(|k| place(k).0),
            uvs: t.map(|k| place(k).1),
        };
        [[0, 1, 3], [1, 2, 3]].map(triangle).to_vec()
    }

    fn turned_over(triangles: &[LeafTriangle]) -> Vec<LeafTriangle> {
        let over = |t: &LeafTriangle| LeafTriangle {
            corners: [t.corners[0], t.corners[2], t.corners[1]],
            uvs: [t.uvs[0], t.uvs[2], t.uvs[1]],
        };
        triangles.iter().map(over).collect()
    }

    fn of(leaves: &[Vec<LeafTriangle>], cutout: Option<u32>) -> Foliage {
        let mut foliage = Foliage::new(vec![disc()]);
        for leaf in leaves {
            foliage.push_leaf(leaf, cutout).unwrap();
        }
        foliage
    }

    fn count(leaf: Vec<LeafTriangle>) -> Option<usize> {
        let foliage = of(&[leaf], Some(0));
        let cards = Cards::of(&foliage);
        cards.triangles_of(LeafId::from_index(0)).map(<[_]>::len)
    }

    #[test]
    fn a_card_is_a_triangle_in_its_plane_with_its_texture() {
        let leaves = [0.0, 5.0].map(|x| card(DVec3::new(x, 1.0, -x), 0.0));
        let foliage = of(&leaves, Some(0));
        let cards = Cards::of(&foliage);
        for (leaf, index) in leaves.iter().zip(0..) {
            let donor = LeafId::from_index(index);
            let triangles = cards.triangles_of(donor).unwrap().to_vec();
            let made = NewLeaf { donor, triangles }.triangles_in(&foliage, 1.0);
            assert_eq!(made.len(), 1);
            let [a, b, d] = leaf[0].corners;
            let facing = (b - a).cross(d - a);
            for (corner, uv) in made[0].corners.into_iter().zip(made[0].uvs) {
                let there = a + uv.x * (b - a) + uv.y * (d - a);
                assert!(there.distance(corner) < 1e-9);
            }
            let [p, q, r] = made[0].corners;
            let area = (q - p).cross(r - p);
            assert!(area.dot(facing) > 0.0);
            // Of a disc of 3/8 of the card's sides.
            let least = 27_f64.sqrt() * 0.375 * 0.375 * facing.length();
            assert!((least..1.2 * least).contains(&(0.5 * area.length())));
        }
    }

    #[test]
    fn corners_have_the_looks_of_the_nearest() {
        let foliage = of(&[card(DVec3::ZERO, 0.0)], Some(0));
        let cards = Cards::of(&foliage);
        let [triangle] = cards.triangles_of(LeafId::from_index(0)).unwrap() else {
            panic!("one triangle");
        };
        let of_card = foliage.triangles();
        for corner in triangle {
            let Place::InPlaneOf { corners, weights } = corner.place else {
                panic!("in the plane of the card");
            };
            assert_eq!(corners, [0, 1, 2]);
            let uv = Weights(weights).at(&of_card[0].uvs);
            let distance = |(t, k): (usize, usize)| of_card[t].uvs[k].distance(uv);
            let own = distance((corner.like as usize / 3, corner.like as usize % 3));
            let all = (0..2).flat_map(|t| (0..3).map(move |k| (t, k)));
            assert!(all.map(distance).all(|other| own <= other));
        }
    }

    #[test]
    fn leaves_of_several_cards_keep_a_triangle_of_each() {
        let at = DVec3::new(1.0, 2.0, 3.0);
        let cross = [card(at, 0.0), card(at + 0.1, 0.0)].concat();
        assert_eq!(count(cross), Some(2));
        let sides = [card(at, 0.0), turned_over(&card(at, 0.0))].concat();
        let foliage = of(std::slice::from_ref(&sides), Some(0));
        let cards = Cards::of(&foliage);
        let donor = LeafId::from_index(0);
        let triangles = cards.triangles_of(donor).unwrap().to_vec();
        let made = NewLeaf { donor, triangles }.triangles_in(&foliage, 1.0);
        assert_eq!(made.len(), 2);
        let facing = |t: &LeafTriangle| {
            let [a, b, c] = t.corners;
            (b - a).cross(c - a).normalize()
        };
        assert!(facing(&made[0]).dot(facing(&sides[0])) > 0.99);
        assert!(facing(&made[1]).dot(facing(&sides[2])) > 0.99);
        // A triangle of no card stays beside one.
        let odd = LeafTriangle {
            corners: [DVec3::ZERO, DVec3::X, DVec3::Y],
            uvs: [DVec2::ZERO, DVec2::X, DVec2::Y],
        };
        assert_eq!(count([card(at, 0.0), vec![odd]].concat()), Some(2));
    }

    #[test]
    fn what_is_no_flat_card_has_no_such_triangle() {
        let at = DVec3::new(1.0, 2.0, 3.0);
        let flat = card(at, 0.0);
        assert_eq!(count(flat.clone()), Some(1));
        // The longest edge is 3.6.
        assert_eq!(count(card(at, 0.07)), Some(1), "hardly bent");
        assert_eq!(count(card(at, 0.08)), None, "bent");
        assert_eq!(count(flat[..1].to_vec()), None, "a triangle");
        let mut folded = flat.clone();
        folded[1].uvs = [1, 0, 2].map(|k| folded[1].uvs[k]);
        assert_eq!(count(folded), None, "folded texture");
        let mut pointed = flat.clone();
        pointed
            .iter_mut()
            .for_each(|t| t.uvs = [DVec2::splat(0.5); 3]);
        assert_eq!(count(pointed), None, "one texel");
        let many = flat.repeat(MAX_TRIANGLES / 2 + 1);
        assert_eq!(count(many), None, "too many");
        let foliage = of(&[flat], None);
        assert!(
            Cards::of(&foliage)
                .triangles_of(LeafId::from_index(0))
                .is_none()
        );
    }

    #[test]
    fn of_very_many_different_cards_the_first_are_looked_at() {
        let leaf = |k: usize| {
            let mut leaf = card(DVec3::X * k as f64, 0.0);
            let moved = 1e-6 * (k % (MAX_CARD_TEXTURES + 1)) as f64;
            let uvs = leaf.iter_mut().flat_map(|t| &mut t.uvs);
            uvs.for_each(|uv| *uv += moved);
            leaf
        };
        let leaves: Vec<_> = (0..MAX_CARD_TEXTURES + 2).map(leaf).collect();
        let cards = Cards::of(&of(&leaves, Some(0)));
        let is_found = |k: usize| cards.triangles_of(LeafId::from_index(k)).is_some();
        assert!((0..MAX_CARD_TEXTURES).all(is_found));
        assert!(!is_found(MAX_CARD_TEXTURES));
        assert!(is_found(MAX_CARD_TEXTURES + 1), "as the first");
    }

    /// A leaf that may keep fewer triangles than it has cards becomes coarser as others do.
    #[test]
    fn cards_become_triangles_where_they_may_keep_no_more() {
        let cross = [card(DVec3::ZERO, 0.0), card(DVec3::splat(0.1), 0.0)].concat();
        let foliage = of(&[card(DVec3::X, 0.0), cross], Some(0));
        let shapes = LossCurves::of(&foliage);
        let after = |most: [usize; 2]| {
            let coarse = coarsen(&foliage, &shapes, &most);
            let coarse = coarse.as_ref().map_or(&foliage, |coarse| coarse.foliage());
            let leaves = (0..2).map(LeafId::from_index);
            leaves
                .map(|leaf| {
                    let is_card = Cards::of(&foliage)
                        .triangles_of(leaf)
                        .is_some_and(|triangles| {
                            let made = NewLeaf {
                                donor: leaf,
                                triangles: triangles.to_vec(),
                            };
                            made.triangles_in(&foliage, 1.0) == coarse.triangles_of(leaf)
                        });
                    (coarse.triangles_of(leaf).len(), is_card)
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(after([2, 4]), [(2, false), (4, false)]);
        assert_eq!(after([1, 3]), [(1, true), (2, true)]);
        assert_eq!(after([1, 1])[0], (1, true));
        assert!(!after([1, 1])[1].1);
    }
}
