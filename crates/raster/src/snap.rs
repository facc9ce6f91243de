//! From world space to integers: the one place where numbers are rounded.
//!
//! A leaf's triangles are scaled, projected in f64, clipped to the near plane
//! and the image, and snapped to 1/256 of a pixel. What leaves here is, for
//! each triangle, a box of pixels and a few planes over it, each three 32-bit
//! integers `[value at the box's first pixel centre, step to the right, step
//! down]`. Both twins then evaluate them by additions, which may wrap:
//!
//! - three *edge functions*, `>= 0` inside. With corners on the grid, the exact
//!   edge function changes by multiples of 256 between pixel centres, so
//!   `floor(E / 256)` keeps its sign. Inside the box `|E| <= width * height` of
//!   the box in grid units, at most (2048 * 256)^2 = 2^38, so the value fits
//!   `i32` after the division, and steps are at most 2^19. The top-left rule is
//!   a bias of one before the division.
//! - *depth*: affine in 1/w, hence exactly linear on the image:
//!   `2^20 + (1 - near / w) * (2^31 - 2^21)`; smaller is nearer. A step may not
//!   fit `i32`, which wrapping forgives; rounding it moves a far corner by at
//!   most 2048 units, which the margins of 2^20 absorb.
//! - *texel coordinates* in 1/65536 texel. They are linear in space, not on the
//!   image, so leaves with a cut-out that are deep for their distance are cut
//!   into smaller triangles first ([`AFFINE_DEPTH_RATIO`]).
//!
//! f64 additions, multiplications, divisions and square roots are the same on
//! every platform; nothing else is used.

use std::cmp::Ordering::Less;

use glam::{DVec2, DVec3};
use secateur_model::{Cutout, Facing, Leaf, LeafTriangle, Wrap};

use crate::View;

/// Grid steps per pixel.
pub const SUBPIXELS: i64 = 256;

/// A leaf whose farthest corner is up to this part farther than its nearest is
/// textured as if texel coordinates were linear on the image: an error of at
/// most a 64th of the leaf. [`View::with_exact_textures`] asks for less.
pub const AFFINE_DEPTH_RATIO: f64 = 1.0 / 16.0;

/// How often a leaf is cut in four at most, for exact textures.
const MAX_CUTS: u32 = 4;

const DEPTH_MARGIN: f64 = (1u64 << 20) as f64;
const DEPTH_RANGE: f64 = ((1u64 << 31) - (1u64 << 21)) as f64;
const TEXEL_ONE: f64 = 65536.0;

/// A triangle on the pixel grid; plain words, uploaded to the GPU as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SnappedTriangle {
    /// Number of the leaf it belongs to, from 1.
    pub leaf: u32,
    /// 0, or one more than the index of the leaf's cut-out.
    pub cutout: u32,
    /// First pixel of the box: column, and row times 65536.
    pub first_pixel: u32,
    /// Size of the box in pixels: width, and height times 65536.
    pub size: u32,
    /// Edge functions, all `>= 0` at the pixel centres inside.
    pub edges: [[i32; 3]; 3],
    /// Depth as a plane over the box, larger for what is further away.
    pub depth: [i32; 3],
    /// Column in the cut-out, in 1/65536 texel.
    pub u: [i32; 3],
    /// Row in the cut-out, in 1/65536 texel.
    pub v: [i32; 3],
}

/// What all triangles of a leaf have in common.
#[derive(Clone, Copy)]
struct Name {
    /// The leaf ID, as in [`SnappedTriangle::leaf`].
    leaf: u32,
    /// The number of the cut-out, as in [`SnappedTriangle::cutout`].
    cutout: u32,
    facing: Facing,
}

/// Turns leaves into [`SnappedTriangle`]s for one view.
#[derive(Clone, Copy, Debug)]
pub struct Snapper<'a> {
    view: &'a View,
    resolution: f64,
    half_px: f64,
    focal_px: f64,
}

/// A corner in camera space.
#[derive(Clone, Copy)]
struct CameraCorner {
    position: DVec3,
    uv: DVec2,
}

/// A corner on the image.
#[derive(Clone, Copy)]
struct ImageCorner {
    px: DVec2,
    /// Depth as a real number.
    depth: f64,
    uv: DVec2,
}

impl<'a> Snapper<'a> {
    /// For a view drawn at `resolution` x `resolution` pixels.
    pub fn new(view: &'a View, resolution: u32) -> Self {
        let half_px = 0.5 * f64::from(resolution);
        Self {
            view,
            resolution: f64::from(resolution),
            half_px,
            focal_px: half_px / view.tan_half_fov,
        }
    }

    /// Calls `emit` with the triangles of a leaf that cover a pixel centre or
    /// might.
    ///
    /// `leaf_number` from 1; `triangles` at original size; `area_scale` as in
    /// [`Lod`](secateur_model::Lod); `cutout` the leaf's alpha mask.
    #[inline]
    pub fn snap_leaf(
        &self,
        leaf_number: u32,
        leaf: &Leaf,
        triangles: &[LeafTriangle],
        area_scale: f64,
        cutout: Option<&Cutout>,
        mut emit: impl FnMut(&SnappedTriangle),
    ) {
        let linear_scale = area_scale.sqrt();
        let name = Name {
            leaf: leaf_number,
            cutout: match cutout {
                Some(_) => leaf.cutout().map_or(0, |index| index + 1),
                None => 0,
            },
            facing: leaf.facing(),
        };
        let cuts = cutout.map_or(0, |_| {
            self.cuts_for_affine(leaf.centre(), linear_scale, triangles)
        });
        for triangle in triangles {
            let corners = of_each([0, 1, 2], |k| CameraCorner {
                position: self.camera_from_leaf(leaf.centre(), linear_scale, triangle.corners[k]),
                uv: triangle.uvs[k],
            });
            let mut snap = |c: [CameraCorner; 3]| self.snap_triangle(name, c, cutout, &mut emit);
            if cuts == 0 {
                snap(corners);
            } else {
                cut_in_four(corners, cuts, &mut snap);
            }
        }
    }

    #[inline(always)]
    fn camera_from_leaf(&self, centre: DVec3, linear_scale: f64, corner: DVec3) -> DVec3 {
        let world = if linear_scale == 1.0 {
            corner
        } else {
            centre + (corner - centre) * linear_scale
        };
        self.view.camera_from_world(world)
    }

    fn cuts_for_affine(&self, centre: DVec3, linear_scale: f64, triangles: &[LeafTriangle]) -> u32 {
        let corners = || {
            let corners = triangles.iter().flat_map(|t| &t.corners);
            corners.map(|c| self.camera_from_leaf(centre, linear_scale, *c))
        };
        let (mut lo, mut hi) = (f64::INFINITY, 0.0);
        for DVec3 { z: w, .. } in corners() {
            lo = if w < lo { w } else { lo };
            hi = if w > hi { w } else { hi };
        }
        if hi <= self.view.near {
            return 0;
        }
        let nearest = lo.max(self.view.near);
        let mut excess = hi / nearest - 1.0;
        if excess <= self.view.affine_depth_ratio {
            return 0;
        }
        let box_of = |(lo, hi): (DVec3, DVec3), at: DVec3| (lo.min(at), hi.max(at));
        let (lo, hi) = corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), box_of);
        // On the image: what is farther off is drawn nearer to the middle, too.
        let across = (hi - lo) + excess * lo.abs().max(hi.abs());
        let mut width_px = across.truncate().max_element() * self.focal_px / nearest;
        let mut cuts = 0;
        // Along each axis a texel is out of place by at most a quarter of the excess, as a part of the
        // width.
        while excess > self.view.affine_depth_ratio
            && (0.25 * excess * width_px).partial_cmp(&self.view.affine_error_px) != Some(Less)
            && cuts < MAX_CUTS
        {
            excess *= 0.5;
            width_px *= 0.5;
            cuts += 1;
        }
        cuts
    }

    #[inline]
    fn snap_triangle(
        &self,
        name: Name,
        corners: [CameraCorner; 3],
        cutout: Option<&Cutout>,
        emit: &mut impl FnMut(&SnappedTriangle),
    ) {
        let near = self.view.near;
        let in_front = corners.iter().filter(|c| c.position.z >= near).count();
        if in_front == 0 {
            return;
        }
        if in_front == 3 {
            let image = of_each(corners, |c| self.project(c));
            let inside = |p: DVec2| p.min_element() >= 0.0 && p.max_element() <= self.resolution;
            if image.iter().all(|c| inside(c.px)) {
                if let Some(triangle) = set_up(name, image, cutout) {
                    emit(&triangle);
                }
                return;
            }
        }
        self.snap_clipped(name, corners, cutout, emit);
    }

    #[cold]
    fn snap_clipped(
        &self,
        name: Name,
        corners: [CameraCorner; 3],
        cutout: Option<&Cutout>,
        emit: &mut impl FnMut(&SnappedTriangle),
    ) {
        let near = self.view.near;
        let front = clip(
            &corners,
            |c| c.position.z - near,
            |a, b, t| CameraCorner {
                position: a.position + t * (b.position - a.position),
                uv: a.uv + t * (b.uv - a.uv),
            },
        );
        let mut polygon: Vec<ImageCorner> = front
            .into_iter()
            .map(|mut c| {
                // The clip's rounding must not put a corner behind the plane.
                c.position.z = c.position.z.max(near);
                self.project(c)
            })
            .collect();
        let size = self.resolution;
        let sides: [fn(DVec2, f64) -> f64; 4] =
            [|p, _| p.x, |p, s| s - p.x, |p, _| p.y, |p, s| s - p.y];
        for side in sides {
            polygon = clip(
                &polygon,
                |c| side(c.px, size),
                |a, b, t| ImageCorner {
                    px: a.px + t * (b.px - a.px),
                    depth: a.depth + t * (b.depth - a.depth),
                    uv: a.uv + t * (b.uv - a.uv),
                },
            );
        }
        for corner in &mut polygon {
            corner.px = corner.px.clamp(DVec2::ZERO, DVec2::splat(size));
        }
        for k in 2..polygon.len() {
            let fan = [polygon[0], polygon[k - 1], polygon[k]];
            if let Some(triangle) = set_up(name, fan, cutout) {
                emit(&triangle);
            }
        }
    }

    #[inline]
    fn project(&self, corner: CameraCorner) -> ImageCorner {
        let inverse_w = 1.0 / corner.position.z;
        let scale = self.focal_px * inverse_w;
        ImageCorner {
            px: DVec2::new(
                self.half_px + scale * corner.position.x,
                self.half_px - scale * corner.position.y,
            ),
            depth: DEPTH_MARGIN + DEPTH_RANGE * (1.0 - self.view.near * inverse_w),
            uv: corner.uv,
        }
    }
}

/// `map` of an array is not always inlined, and this is where time goes.
#[inline(always)]
fn of_each<T: Copy, U>([a, b, c]: [T; 3], f: impl Fn(T) -> U) -> [U; 3] {
    [f(a), f(b), f(c)]
}

/// The part of a polygon where `distance` is not negative (Sutherland and
/// Hodgman's rule for one plane).
fn clip<C: Copy>(
    polygon: &[C],
    distance: impl Fn(&C) -> f64,
    between: impl Fn(&C, &C, f64) -> C,
) -> Vec<C> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, a) in polygon.iter().enumerate() {
        let b = &polygon[(k + 1) % polygon.len()];
        let (da, db) = (distance(a), distance(b));
        if da >= 0.0 {
            kept.push(*a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            // From the inner corner, so that an edge two triangles share is cut
            // at the same point whichever way round it is walked.
            let (a, b, da, db) = if da >= 0.0 {
                (a, b, da, db)
            } else {
                (b, a, db, da)
            };
            kept.push(between(a, b, da / (da - db)));
        }
    }
    kept
}

fn cut_in_four(corners: [CameraCorner; 3], cuts: u32, snap: &mut impl FnMut([CameraCorner; 3])) {
    if cuts == 0 {
        return snap(corners);
    }
    let [a, b, c] = corners;
    let middle = |p: CameraCorner, q: CameraCorner| CameraCorner {
        position: 0.5 * (p.position + q.position),
        uv: 0.5 * (p.uv + q.uv),
    };
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
        cut_in_four(part, cuts - 1, snap);
    }
}

/// Snaps a triangle that lies in the image and prepares its planes; `None`
/// where it has no area on the grid or its box holds no pixel centre.
#[inline]
fn set_up(
    name: Name,
    corners: [ImageCorner; 3],
    cutout: Option<&Cutout>,
) -> Option<SnappedTriangle> {
    // Floor, not a call to round: images lie at coordinates >= 0.
    let snap = |px: f64| (px * SUBPIXELS as f64 + 0.5) as i64;
    let x = of_each(corners, |c| snap(c.px.x));
    let y = of_each(corners, |c| snap(c.px.y));
    // Pixel centres lie at multiples of 256, plus 128.
    let first = |v: [i64; 3]| (v[0].min(v[1]).min(v[2]) + 127) >> 8;
    let last = |v: [i64; 3]| (v[0].max(v[1]).max(v[2]) - 128) >> 8;
    let (x0, y0, x1, y1) = (first(x), first(y), last(x), last(y));
    if x1 < x0 || y1 < y0 {
        return None;
    }
    let twice_area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    // Rows count downwards, so counterclockwise in the world is negative here.
    let is_seen = match name.facing {
        Facing::Both => twice_area != 0,
        Facing::Counterclockwise => twice_area < 0,
        Facing::Clockwise => twice_area > 0,
    };
    if !is_seen {
        return None;
    }
    let (centre_x, centre_y) = (x0 * SUBPIXELS + 128, y0 * SUBPIXELS + 128);
    let edge = |i: usize, j: usize| {
        // Turned so that the inside is positive whichever way the leaf faces.
        let (i, j) = if twice_area > 0 { (i, j) } else { (j, i) };
        let (dx, dy) = (x[j] - x[i], y[j] - y[i]);
        let is_top_left = dy < 0 || (dy == 0 && dx > 0);
        let exact = dx * (centre_y - y[i]) - dy * (centre_x - x[i]);
        let biased = exact - i64::from(!is_top_left);
        [(biased >> 8) as i32, -dy as i32, dx as i32]
    };
    let edges = [edge(0, 1), edge(1, 2), edge(2, 0)];

    let per_area = 1.0 / twice_area as f64;
    let (ox, oy) = ((centre_x - x[0]) as f64, (centre_y - y[0]) as f64);
    let (ax, ay) = ((x[1] - x[0]) as f64, (y[1] - y[0]) as f64);
    let (bx, by) = ((x[2] - x[0]) as f64, (y[2] - y[0]) as f64);
    let plane = |at: [f64; 3]| {
        let (da, db) = (at[1] - at[0], at[2] - at[0]);
        let step_x = (da * by - db * ay) * per_area;
        let step_y = (db * ax - da * bx) * per_area;
        let start = at[0] + step_x * ox + step_y * oy;
        [
            round(start),
            round(step_x * SUBPIXELS as f64),
            round(step_y * SUBPIXELS as f64),
        ]
    };
    let depth = plane(of_each(corners, |c| c.depth));
    let (u, v) = match cutout {
        None => ([0; 3], [0; 3]),
        Some(mask) => {
            let wrap = mask.wrap();
            let us = texels(of_each(corners, |c| c.uv.x), wrap[0], mask.width());
            let vs = texels(of_each(corners, |c| c.uv.y), wrap[1], mask.height());
            (plane(us), plane(vs))
        }
    };
    Some(SnappedTriangle {
        leaf: name.leaf,
        cutout: name.cutout,
        first_pixel: x0 as u32 | (y0 as u32) << 16,
        size: (x1 - x0 + 1) as u32 | ((y1 - y0 + 1) as u32) << 16,
        edges,
        depth,
        u,
        v,
    })
}

/// To the nearest integer, kept modulo 2^32: steps may leave 32 bits, the
/// values they add up to do not.
#[inline]
fn round(value: f64) -> i32 {
    (value + if value < 0.0 { -0.5 } else { 0.5 }) as i64 as i32
}

/// Texture coordinates of a triangle's corners as texel coordinates in 1/65536
/// texel, moved by whole periods to where they fit 32 bits.
fn texels(at: [f64; 3], wrap: Wrap, size: u32) -> [f64; 3] {
    let shifted = match wrap {
        Wrap::ClampToEdge => at.map(|t| t.clamp(-7.0, 7.0)),
        Wrap::Repeat | Wrap::MirroredRepeat => {
            let lowest = at[0].min(at[1]).min(at[2]);
            let whole = 2.0 * (0.5 * lowest).floor();
            at.map(|t| t - whole)
        }
    };
    shifted.map(|t| t * f64::from(size) * TEXEL_ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How often a leaf is cut that goes from this place to one a tenth farther off, both `width` wide,
    /// where a unit at its near end takes this many pixels.
    fn cuts(view: &View, from: DVec3, width: f64, px_per_unit: f64) -> u32 {
        let to = DVec3::new(from.x, from.y, 1.1 * from.z);
        let beside = DVec3::X * width;
        let leaf = [[from, from + beside, to + beside], [from, to + beside, to]];
        let snapper = Snapper {
            focal_px: -from.z * px_per_unit,
            ..Snapper::new(view, 1)
        };
        snapper.cuts_for_affine(DVec3::ZERO, 1.0, &leaf.map(LeafTriangle::plain))
    }

    /// A tenth is cut once to get below a 16th, and five times to get below a 256th, of which four are
    /// made; a leaf of w pixels cut n times is out of place by w / 40 / 4^n of them, at most a 64th until
    /// no more cuts are made.
    #[test]
    fn leaves_are_cut_no_further_than_a_64th_of_a_pixel_asks_for() {
        let view = View::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 1.0, 0.01).unwrap();
        let exact = view.with_exact_textures();
        // In the middle of the image, where the far end of a leaf is drawn just beside its near end.
        let amid = |view: &View, px: f64| cuts(view, DVec3::Z * -9.5, px, 1.0);
        assert_eq!([1.0, 10.0, 1000.0].map(|px| amid(&view, px)), [1; 3]);
        let of_sizes = [0.5, 1.0, 2.0, 2.4, 9.0, 11.0, 36.0, 41.0, 1000.0];
        let of_sizes = of_sizes.map(|px| amid(&exact, px));
        assert_eq!(of_sizes, [0, 1, 1, 2, 2, 3, 3, 4, 4]);
        // A thread that points away from the eye, off the middle of the image: its far end is drawn a
        // tenth nearer to the middle.
        let off_middle = |px: f64| cuts(&exact, DVec3::new(10.0 * px, 0.0, -9.5), 1e-9, 1.0);
        assert_eq!([0.5, 2.0, 9.0, 36.0, 41.0].map(off_middle), [0, 1, 2, 3, 4]);
        // No width at all is no reason to cut less where no error is allowed.
        assert_eq!(cuts(&view, DVec3::Z * -9.5, 0.0, 1.0), 1);
    }
}
