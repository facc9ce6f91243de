//! Cells side by side in one texture of colours and one of normals.

use std::sync::Arc;

use glam::Vec2;
use secateur_model::{AlphaMode, Filters, Finish, Material, NormalMap, Texture, Wrap};

use super::cell::Cell;
use super::coverage::CUTOFF;

/// The share of a cell's side that stays empty at each edge, so that neighbours do not run into each
/// other in the first mip maps.
pub const BORDER: f64 = 1.0 / 16.0;

/// The colours and normals of cells.
pub(super) struct Atlas {
    /// Texels a side of a cell.
    pub(super) cell: u32,
    /// Cells across and down.
    pub(super) cells: [u32; 2],
    pub(super) rgba: Vec<u8>,
    pub(super) normals: Vec<u8>,
}

impl Atlas {
    pub(super) fn new(cell: u32, cells: [u32; 2]) -> Self {
        let texels = (cell * cells[0]) as usize * (cell * cells[1]) as usize;
        Self {
            cell,
            cells,
            rgba: vec![0; 4 * texels],
            normals: [128, 128, 255, 255].repeat(texels),
        }
    }

    /// Puts a cell in its place, counted from the upper left.
    pub(super) fn put(&mut self, baked: &Cell, [across, down]: [u32; 2]) {
        assert_eq!(baked.side, self.cell, "cells of one size");
        let width = (self.cell * self.cells[0]) as usize;
        let side = self.cell as usize;
        for at in 0..side * side {
            let (x, y) = (at % side, at / side);
            let texel = (down as usize * side + y) * width + across as usize * side + x;
            let [r, g, b] = baked.colors[at].to_array().map(srgb_byte);
            self.rgba[4 * texel..][..4].copy_from_slice(&[r, g, b, baked.alphas[at]]);
            let [x, y, z] = baked.normals[at].to_array().map(direction_byte);
            self.normals[4 * texel..][..4].copy_from_slice(&[x, y, z, 255]);
        }
    }

    /// Texture coordinates of a place in a cell, in texels from its middle, right and down.
    pub(super) fn uv(&self, [across, down]: [u32; 2], from_middle: Vec2) -> Vec2 {
        let middle = Vec2::new(across as f32 + 0.5, down as f32 + 0.5) * self.cell as f32;
        let size = Vec2::new(self.cells[0] as f32, self.cells[1] as f32) * self.cell as f32;
        (middle + from_middle) / size
    }

    /// The glTF material that draws the atlas.
    pub(super) fn material(&self) -> Material {
        let size = self.cells.map(|count| count * self.cell);
        material(size, self.rgba.clone(), self.normals.clone())
    }
}

/// What draws a texture of colours and one of normals: cut out, both sides, lit.
pub(super) fn material([width, height]: [u32; 2], rgba: Vec<u8>, normals: Vec<u8>) -> Material {
    let texture = |rgba: Vec<u8>| {
        Arc::new(Texture {
            width,
            height,
            rgba,
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters::default(),
        })
    };
    Material {
        name: "impostor".to_owned(),
        base_color: [1.0; 4],
        texture: Some(texture(rgba)),
        alpha_mode: AlphaMode::Mask(CUTOFF),
        double_sided: true,
        finish: Finish {
            normal_map: Some(NormalMap {
                texture: texture(normals),
                scale: 1.0,
            }),
            ..Finish::default()
        },
    }
}

/// A linear value of 0 to 1 as an sRGB byte (IEC 61966-2-1).
pub(crate) fn srgb_byte(linear: f32) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let s = match linear <= 0.003_130_8 {
        true => linear * 12.92,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    };
    (s * 255.0).round() as u8
}

/// -1 to 1 as 0 to 255.
pub(super) fn direction_byte(x: f32) -> u8 {
    ((x.clamp(-1.0, 1.0) + 1.0) * 127.5).round() as u8
}
