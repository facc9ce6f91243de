//! Rectangles of two triangles each.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2, Vec3};
use secateur_model::{Material, Surface};

/// Rectangles with texture coordinates.
#[derive(Default)]
pub(super) struct Quads {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
}

impl Quads {
    /// Adds one of this half width and height, with axes to the right, up and toward who sees its
    /// front, and the texture coordinates of its upper left and lower right corner.
    pub(super) fn push(
        &mut self,
        centre: DVec3,
        [right, up, toward]: [DVec3; 3],
        half: DVec2,
        [upper_left, lower_right]: [Vec2; 2],
    ) {
        let first = self.positions.len() as u32;
        // Counterclockwise from the upper left.
        for [x, y] in [[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]] {
            self.positions
                .push(centre + right * (x * half.x) + up * (y * half.y));
            let u = if x < 0.0 { upper_left.x } else { lower_right.x };
            let v = if y > 0.0 { upper_left.y } else { lower_right.y };
            self.uvs.push(Vec2::new(u, v));
        }
        self.normals.extend([toward.as_vec3(); 4]);
        let corners = [[0, 1, 2], [0, 2, 3]];
        self.triangles
            .extend(corners.map(|t| t.map(|corner| first + corner)));
    }

    /// All of them with one material.
    pub(super) fn surface(self, material: Material) -> Surface {
        Surface {
            positions: self.positions,
            normals: self.normals,
            uvs: self.uvs,
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: self.triangles,
            material: Arc::new(material),
        }
    }
}
