//! What each instance is drawn as.

use secateur_levels::leaf_boxes::{OrientedBox, cut};
use secateur_model::LeafId;
use secateur_runtime::stand::{Instance, LeavesByHeight, StandCamera, seen};
use secateur_runtime::view_dependent::{Both, InFrontOf, LargerThan, OutsideSphere, ViewDependent};

use crate::draw_list::{ChainKind, DrawList, Item, Listed};
use crate::species::Species;
use crate::uploaded::{PICTURE_SIDE, SHARES, Uploaded};

/// How trees are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    /// Every leaf and all wood.
    Full,
    /// Levels of half as many leaves each; the coarsest that has as many as [`RULE`] wants.
    Chain,
    /// Just as many leaves as [`RULE`] wants: a prefix of the index buffer.
    Continuous,
    /// As [`Self::Continuous`], each leaf fading over the last of the steps before it goes.
    Fading,
    /// VDF's variable levels: coarse within a sphere in the crown that grows with the distance.
    Spheres,
    /// Boxes with pictures (Hybrid 4.2), and leaves where these are too small on the screen.
    Boxes,
    /// View-dependent where near, continuous farther off, the whole plant's box far off.
    Mix,
    /// One of L-plants' schemes.
    Scheme(Scheme),
}

/// How fast levels lose leaves (L-plants VI).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scheme {
    /// Shares of trees by level, finest first: 50, 25, 12.5 and 12.5 per cent.
    Halving,
    /// A quarter of the trees at each level.
    Even,
}

/// How many leaves a tree needs. With these 2,000 oaks are drawn 27 times as fast as by full geometry, with a
/// FLIP of .034 against it; docs/lod-model.md has what more and fewer do.
pub(crate) const RULE: LeavesByHeight = LeavesByHeight {
    leaves_a_px2: 0.35,
    fewest: 120,
};

/// A mix draws trees of more pixels view-dependently.
const NEAR_PX: f64 = 320.0;

/// The radius in pixels up to which a leaf needs no more detail.
const LEAF_RADIUS_PX: f64 = 6.0;

/// Boxes are drawn as pictures up to this number of pixels a texel of their pictures.
const TEXEL_PX: f64 = 1.0;

/// A box fades into what is below it until it is larger by this share.
const BLEND: f64 = 0.3;

/// The last steps before its removal over which a leaf fades, as a share of the steps that its level is
/// from the coarsest one.
const FADE: f64 = 0.05;

/// Where the last of a scheme's levels ends, in radii of the plant; its bands are equally wide.
const SCHEME_REACH: f64 = 50.0;

impl Method {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Full => "full geometry",
            Self::Chain => "discrete chain",
            Self::Continuous => "continuous",
            Self::Fading => "continuous, fading",
            Self::Spheres => "view-dependent, spheres",
            Self::Boxes => "boxes with pictures",
            Self::Mix => "mix",
            Self::Scheme(Scheme::Halving) => "scheme 50-25-12.5-12.5",
            Self::Scheme(Scheme::Even) => "scheme 25-25-25-25",
        }
    }
}

/// All trees of the forest: their species, its buffers, and where each stands.
pub(crate) struct Stand<'a> {
    pub(crate) species: &'a Species,
    pub(crate) uploaded: &'a Uploaded,
    pub(crate) instances: &'a [Instance],
    /// One cut for all trees, which goes from one to the next.
    pub(crate) cut: ViewDependent,
    pub(crate) rule: LeavesByHeight,
}

/// A tree that may be seen.
struct Tree {
    instance: Instance,
    index: usize,
    distance: f64,
    pixels_high: f64,
}

impl Stand<'_> {
    /// What a camera's frame takes. Levels are those that the tree has from `levels_from`: the eye,
    /// but for a picture of the levels that were.
    pub(crate) fn frame(
        &mut self,
        method: Method,
        camera: &StandCamera,
        levels_from: glam::DVec3,
    ) -> DrawList {
        let sphere = self.species.sphere;
        let mut list = DrawList::default();
        for seen in seen(self.instances, sphere, camera) {
            let instance = self.instances[seen.index];
            let distance = instance.to_world(sphere.centre).distance(levels_from);
            let radius = instance.scale * sphere.radius;
            let tree = Tree {
                instance,
                index: seen.index,
                distance,
                pixels_high: camera
                    .screen
                    .pixels_high(2.0 * radius, distance.max(radius)),
            };
            self.tree(&mut list, method, &tree, camera, levels_from);
        }
        list.finish()
    }

    fn tree(
        &mut self,
        list: &mut DrawList,
        method: Method,
        tree: &Tree,
        camera: &StandCamera,
        levels_from: glam::DVec3,
    ) {
        let leaves = self.leaves_of(tree.pixels_high);
        match method {
            Method::Full => list.level(ChainKind::Halvings, 0, item(tree, 1.0)),
            Method::Chain => {
                let levels = &self.uploaded.halvings;
                let coarsest = levels.iter().rposition(|level| level.leaf_count >= leaves);
                list.level(ChainKind::Halvings, coarsest.unwrap_or(0), item(tree, 1.0));
            }
            Method::Continuous => {
                self.push_leaves(list, tree, leaves, 1.0, 0.0);
                self.push_wood(list, tree, leaves);
            }
            Method::Fading => {
                self.push_leaves(list, tree, leaves, 1.0, FADE);
                self.push_wood(list, tree, leaves);
            }
            Method::Spheres => {
                let sphere = self.species.sphere;
                let all = self.species.leaves.model.most_leaves();
                // As large a share of the plant's sphere is coarse as a uniform level has fewer leaves.
                let coarse = 1.0 - leaves as f64 / all as f64;
                let mut outside = OutsideSphere {
                    centre: sphere.centre,
                    radius: sphere.radius * coarse.cbrt(),
                };
                self.cut.refine(&mut outside);
                self.push_cut(list, tree);
                self.push_wood(list, tree, leaves);
            }
            Method::Boxes => {
                self.push_boxes(list, tree, camera, levels_from);
                self.push_wood(list, tree, leaves);
            }
            Method::Mix => self.mixed(list, tree, leaves, camera, levels_from),
            Method::Scheme(scheme) => self.push_scheme(list, tree, scheme),
        }
    }

    fn leaves_of(&self, pixels_high: f64) -> usize {
        self.rule
            .leaves(pixels_high, self.species.leaves.model.most_leaves())
    }

    fn mixed(
        &mut self,
        list: &mut DrawList,
        tree: &Tree,
        leaves: usize,
        camera: &StandCamera,
        levels_from: glam::DVec3,
    ) {
        let whole_px = f64::from(PICTURE_SIDE) * TEXEL_PX;
        let has_boxes = self.uploaded.boxes.is_some();
        if tree.pixels_high > NEAR_PX {
            let own = |direction| tree.instance.direction_to_own(direction);
            let half_tangent = camera.half_tangents()[1];
            let larger = LargerThan {
                eye: tree.instance.to_own(levels_from),
                pixels_at_unit_distance: camera.screen.height_px / 2.0 / half_tangent,
                radius_px: LEAF_RADIUS_PX,
            };
            // What is behind the eye needs no detail.
            let ahead = InFrontOf {
                point: larger.eye,
                normal: own(camera.forward),
            };
            self.cut.refine(&mut Both(larger, ahead));
            self.push_cut(list, tree);
        } else {
            let over = match has_boxes {
                true => tree.pixels_high / whole_px - 1.0,
                false => f64::INFINITY,
            };
            let shown = (over / BLEND).clamp(0.0, 1.0);
            if shown > 0.0 {
                self.push_leaves(list, tree, leaves, shown as f32, 0.0);
            }
            if shown < 1.0 {
                list.box_planes(0, item(tree, 1.0 - shown as f32));
            }
        }
        self.push_wood(list, tree, leaves);
    }

    /// A prefix of the leaves, which fade over this share of the steps that are left.
    fn push_leaves(&self, list: &mut DrawList, tree: &Tree, leaves: usize, shown: f32, fade: f64) {
        let part = &self.species.leaves;
        let steps = part.model.steps_to(leaves) as u32;
        let steps_left = part.model.order().len() as u32 - steps;
        let place = list.item(Item {
            steps,
            fade_steps: (fade * f64::from(steps_left)) as u32,
            common_scale: part.prefix.common_linear_scale(steps),
            ..item(tree, shown)
        });
        list.calls.push(crate::draw_list::Call::Leaves {
            indices: 3 * part.prefix.triangles_after(steps),
            item: place,
        });
    }

    /// The wood that goes with this number of leaves.
    fn push_wood(&self, list: &mut DrawList, tree: &Tree, leaves: usize) {
        let part = &self.species.wood;
        let steps = self.species.wood_steps(leaves) as u32;
        let place = list.item(Item {
            steps,
            ..item(tree, 1.0)
        });
        list.calls.push(crate::draw_list::Call::Wood {
            indices: 3 * part.prefix.triangles_after(steps),
            item: place,
        });
    }

    /// The leaves of the cut, as a list.
    fn push_cut(&self, list: &mut DrawList, tree: &Tree) {
        let place = list.item(item(tree, 1.0));
        let all = self.species.leaves.prefix.leaves().len();
        for (leaf, area_scale) in self.cut.leaves() {
            let at = self.uploaded.leaves.place_of.get(leaf.index());
            // Orders of viewpoint-driven simplification make no leaves.
            let Some(at) = at.filter(|at| (**at as usize) < all) else {
                continue;
            };
            list.listed.push(self.listed(place, *at, area_scale));
        }
    }

    fn listed(&self, item: u32, place: u32, area_scale: f64) -> Listed {
        let first = &self.uploaded.leaves.first_index[place as usize..];
        Listed {
            item,
            place,
            scale: area_scale.sqrt() as f32,
            first_index: first[0],
            indices: first[1] - first[0],
        }
    }

    fn push_boxes(
        &self,
        list: &mut DrawList,
        tree: &Tree,
        camera: &StandCamera,
        levels_from: glam::DVec3,
    ) {
        let pixels_high = |bounds: &OrientedBox| {
            let distance = tree.instance.to_world(bounds.centre).distance(levels_from);
            let radius = tree.instance.scale * bounds.radius();
            camera
                .screen
                .pixels_high(2.0 * radius, distance.max(radius))
        };
        let most_px = f64::from(PICTURE_SIDE) * TEXEL_PX;
        let cut = cut(&self.species.boxes, most_px, BLEND, pixels_high);
        for (index, weight) in cut.boxes {
            list.box_planes(index, item(tree, weight as f32));
        }
        for (index, weight) in cut.own_leaves {
            let place = list.item(item(tree, weight as f32));
            let own: &[LeafId] = &self.species.boxes[index].own;
            for leaf in own {
                let at = self.uploaded.leaves.place_of[leaf.index()];
                list.listed.push(self.listed(place, at, 1.0));
            }
        }
    }

    fn push_scheme(&self, list: &mut DrawList, tree: &Tree, scheme: Scheme) {
        let left: [f64; 3] = match scheme {
            Scheme::Halving => [0.5, 0.25, 0.125],
            Scheme::Even => [0.75, 0.5, 0.25],
        };
        let band = tree.distance / (SCHEME_REACH * self.species.sphere.radius) * 5.0;
        match band as usize {
            0 => list.level(ChainKind::Halvings, 0, item(tree, 1.0)),
            band @ 1..=3 => {
                let level = SHARES.iter().position(|share| *share == left[band - 1]);
                let level = level.expect("a mesh for each share of the schemes");
                list.level(ChainKind::Shares, level, item(tree, 1.0));
            }
            _ if self.uploaded.boxes.is_some() => list.box_planes(0, item(tree, 1.0)),
            _ => list.level(ChainKind::Shares, SHARES.len() - 1, item(tree, 1.0)),
        }
    }
}

fn item(tree: &Tree, shown: f32) -> Item {
    let instance = &tree.instance;
    let (sin, cos) = instance.yaw.sin_cos();
    Item {
        position: instance.position.as_vec3().to_array(),
        scale: instance.scale as f32,
        turn: [cos as f32, sin as f32],
        steps: 0,
        fade_steps: 0,
        common_scale: 1.0,
        shown,
        seed: (tree.index as u32).wrapping_mul(2_654_435_769),
        padding: 0,
    }
}
