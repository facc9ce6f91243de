//! The surface of leaves: cards, crossed cards, blades and needles.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use secateur_model::{Material, Surface};

use crate::language::Settings;
use crate::{LeafKind, LeafPose, Random};

/// How far a leaf starts from where it grows, as a share of its length: leaves
/// that face each other at a node would share an edge, and so be one.
const GAP: f64 = 0.01;

/// The surface of these leaves, in order, no vertex shared between two. The
/// texture's bottom middle is a leaf's base.
pub(crate) fn leaf_surface(
    poses: &[LeafPose],
    settings: &Settings,
    material: Arc<Material>,
    random: &mut Random,
) -> Surface {
    let triangles = poses.iter().map(|pose| pose.kind.triangles() as usize);
    let triangles: usize = triangles.sum();
    let vertices = triangles + 2 * poses.len();
    let mut builder = Builder {
        surface: Surface {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            uvs: Vec::with_capacity(vertices),
            colors: Vec::with_capacity(vertices),
            holds: Vec::new(),
            triangles: Vec::with_capacity(triangles),
            material,
        },
        centre: middle_of(poses),
        settings,
        color: Vec4::ONE,
    };
    for pose in poses {
        builder.color = tint(random, settings.leaf_variety);
        builder.push(pose);
    }
    builder.surface
}

/// The middle of the leaves' bounding box.
fn middle_of(poses: &[LeafPose]) -> DVec3 {
    let first = poses.first().map_or(DVec3::ZERO, |pose| pose.base);
    let (low, high) = poses.iter().fold((first, first), |(low, high), pose| {
        (low.min(pose.base), high.max(pose.base))
    });
    0.5 * (low + high)
}

/// A linear vertex colour: leaves differ in brightness and in how yellow they are.
fn tint(random: &mut Random, variety: f64) -> Vec4 {
    let brightness = 0.815 + 0.27 * variety * random.between(-1.0, 1.0);
    let yellow = 0.24 * variety * random.between(-1.0, 1.0);
    let channel = |share: f64| (brightness * share).clamp(0.0, 1.0) as f32;
    Vec4::new(
        channel(1.0 + yellow),
        channel(1.0),
        channel(1.0 - yellow),
        1.0,
    )
}

struct Builder<'a> {
    surface: Surface,
    centre: DVec3,
    settings: &'a Settings,
    color: Vec4,
}

/// Directions of a leaf: to its right, towards its tip, out of its upper face.
#[derive(Clone, Copy)]
struct Axes {
    right: DVec3,
    along: DVec3,
    facing: DVec3,
}

impl Builder<'_> {
    fn push(&mut self, pose: &LeafPose) {
        let axes = Axes {
            right: pose.along.cross(pose.facing),
            along: pose.along,
            facing: pose.facing,
        };
        let base = pose.base + pose.along * (GAP * pose.length_m);
        match pose.kind {
            LeafKind::Quad => {
                self.push_grid(base, axes, [pose.width_m, pose.length_m], [1, 1], [0.0; 2])
            }
            LeafKind::Blade { triangles } => {
                let settings = self.settings;
                let bends = [settings.leaf_droop_degrees, settings.leaf_fold_degrees];
                let size_m = [pose.width_m, pose.length_m];
                self.push_grid(base, axes, size_m, grid(triangles), bends);
            }
            LeafKind::Crossed => self.push_crossed(base, axes, [pose.width_m, pose.length_m]),
            LeafKind::Needle => self.push_needle(base, axes, [pose.width_m, pose.length_m]),
        }
    }

    fn vertex(&mut self, position: DVec3, facing: DVec3, uv: DVec2) -> u32 {
        let outward = (position - self.centre).normalize_or(facing);
        let normal = facing.lerp(outward, self.settings.leaf_outward);
        let index = self.surface.positions.len() as u32;
        self.surface.positions.push(position);
        self.surface
            .normals
            .push(normal.as_vec3().normalize_or(Vec3::Y));
        self.surface.uvs.push(Vec2::new(uv.x as f32, uv.y as f32));
        self.surface.colors.push(self.color);
        index
    }

    /// Columns and rows of two triangles each. The tip droops and the halves are
    /// raised by these angles in degrees.
    fn push_grid(
        &mut self,
        base: DVec3,
        axes: Axes,
        [width_m, length_m]: [f64; 2],
        [columns, rows]: [u32; 2],
        [droop, fold]: [f64; 2],
    ) {
        let half_width_m = 0.5 * width_m;
        let (fold_sin, fold_cos) = libm::sincos(fold.to_radians());
        let first = self.surface.positions.len() as u32;
        let mut middle = base;
        for row in 0..=rows {
            let share = f64::from(row) / f64::from(rows);
            // The middle line is an arc, walked in chords.
            let (sin, cos) = libm::sincos((droop * share).to_radians());
            let facing = axes.facing * cos + axes.along * sin;
            for column in 0..=columns {
                let aside = 2.0 * f64::from(column) / f64::from(columns) - 1.0;
                let raised = aside.abs() * half_width_m * fold_sin;
                let across = axes.right * (aside * half_width_m * fold_cos);
                let uv = DVec2::new(0.5 + 0.5 * aside, 1.0 - share);
                self.vertex(middle + across + facing * raised, facing, uv);
            }
            let half_step = droop * (share + 0.5 / f64::from(rows));
            let (sin, cos) = libm::sincos(half_step.to_radians());
            middle += (axes.along * cos - axes.facing * sin) * (length_m / f64::from(rows));
        }
        for row in 0..rows {
            for column in 0..columns {
                let a = first + row * (columns + 1) + column;
                let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
                self.surface.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// Four half cards around the line from base to tip.
    fn push_crossed(&mut self, base: DVec3, axes: Axes, [width_m, length_m]: [f64; 2]) {
        let half_width_m = 0.5 * width_m;
        let tip = base + axes.along * length_m;
        for (side, facing, edge) in [
            (axes.right, axes.facing, 1.0),
            (-axes.right, axes.facing, 0.0),
            (axes.facing, axes.right, 1.0),
            (-axes.facing, axes.right, 0.0),
        ] {
            let out = side * half_width_m;
            let a = self.vertex(base, facing, DVec2::new(0.5, 1.0));
            let b = self.vertex(base + out, facing, DVec2::new(edge, 1.0));
            let c = self.vertex(tip + out, facing, DVec2::new(edge, 0.0));
            let d = self.vertex(tip, facing, DVec2::new(0.5, 0.0));
            self.surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// Two triangles on both sides of the line from base to tip, like a roof.
    fn push_needle(&mut self, base: DVec3, axes: Axes, [width_m, length_m]: [f64; 2]) {
        let half_width_m = 0.5 * width_m;
        let low = base + axes.along * (0.4 * length_m) - axes.facing * (0.6 * half_width_m);
        let tip = base + axes.along * length_m;
        let [a, b] = [base, tip].map(|p| self.vertex(p, axes.facing, DVec2::new(0.5, 0.5)));
        for side in [1.0, -1.0] {
            let out = axes.right * (side * half_width_m);
            let c = self.vertex(low + out, axes.facing, DVec2::new(0.5, 0.5));
            let triangle = if side > 0.0 { [a, c, b] } else { [a, b, c] };
            self.surface.triangles.push(triangle);
        }
    }
}

/// Columns and rows of a blade: two columns where it can be folded evenly.
fn grid(triangles: u8) -> [u32; 2] {
    let cells = u32::from(triangles) / 2;
    match cells {
        9 => [3, 3],
        _ if cells.is_multiple_of(2) => [2, cells / 2],
        _ => [1, cells],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use secateur_model::AlphaMode;

    fn surface(kind: LeafKind) -> Surface {
        let pose = LeafPose {
            segment: None,
            base: DVec3::ZERO,
            along: DVec3::Y,
            facing: DVec3::Z,
            length_m: 2.0,
            width_m: 1.0,
            kind,
        };
        let settings = Settings {
            leaf_droop_degrees: 90.0,
            leaf_fold_degrees: 0.0,
            ..Settings::default()
        };
        let material = Arc::new(Material {
            name: "leaf".into(),
            base_color: [1.0; 4],
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            finish: secateur_model::Finish::default(),
        });
        leaf_surface(&[pose], &settings, material, &mut Random::new(1))
    }

    #[test]
    fn every_kind_has_its_triangles_and_hangs_together_by_edges() {
        let blades = (1..=9).map(|half| LeafKind::Blade {
            triangles: 2 * half,
        });
        let others = [LeafKind::Quad, LeafKind::Crossed, LeafKind::Needle];
        for kind in others.into_iter().chain(blades) {
            let leaf = surface(kind);
            assert_eq!(leaf.triangles.len(), kind.triangles() as usize, "{kind:?}");
            let glb = secateur_gltf::plant_to_glb(&secateur_model::Plant {
                name: "leaf".into(),
                wood: Surface {
                    triangles: Vec::new(),
                    ..leaf.clone()
                },
                triangles_per_leaf: vec![kind.triangles()],
                leaves: leaf,
                skeleton: None,
                holds: None,
            });
            let document = secateur_gltf::Document::from_bytes("leaf.glb", glb, None);
            let all = ["mesh:*".parse().unwrap()];
            let tree = document.unwrap().into_tree(&all).unwrap();
            assert_eq!(tree.foliage().leaves().len(), 1, "{kind:?}");
        }
    }

    #[test]
    fn a_card_is_as_long_and_wide_as_asked_and_faces_up() {
        let card = surface(LeafKind::Quad);
        let [a, b, c, d] = card.positions[..] else {
            panic!("four corners")
        };
        assert!((b - a - DVec3::X).length() < 1e-12, "{a} to {b}");
        assert!(
            (d - b - DVec3::Y * 2.0).length() < 1e-12 || (c - a - DVec3::Y * 2.0).length() < 1e-12
        );
        let [i, j, k] = card.triangles[0].map(|i| card.positions[i as usize]);
        assert!((j - i).cross(k - i).z > 0.0);
    }

    #[test]
    fn a_blade_droops_along_an_arc() {
        // A quarter circle of length 2 in three chords of 2/3 ends at about its
        // radius 4/pi below and beyond; chords are shorter by 1 %.
        let blade = surface(LeafKind::Blade { triangles: 6 });
        let tip = 0.5 * (blade.positions[6] + blade.positions[7]);
        let radius = 4.0 / std::f64::consts::PI;
        assert!((tip.y - radius).abs() < 0.05, "{tip}");
        assert!((tip.z + radius).abs() < 0.05, "{tip}");
    }
}
