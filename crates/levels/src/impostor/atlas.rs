//! Cells side by side in one texture of colours and one of normals.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use secateur_eval::srgb_byte;
use secateur_model::{AlphaMode, Filters, Finish, Material, Mips, NormalMap, Texture, Wrap};

use super::cell::Cell;
use super::coverage::CUTOFF;

/// The share of a cell's side that stays empty at each edge, so that neighbours do not run into each
/// other in the first mip maps.
pub const BORDER: f64 = 1.0 / 16.0;

/// The colours and normals of cells.
pub(super) struct Atlas {
    /// Width and height in texels.
    pub(super) size: [u32; 2],
    pub(super) rgba: Vec<u8>,
    pub(super) normals: Vec<u8>,
}

impl Atlas {
    pub(super) fn new(size: [u32; 2]) -> Self {
        let texels = size[0] as usize * size[1] as usize;
        Self {
            size,
            rgba: vec![0; 4 * texels],
            normals: [128, 128, 255, 255].repeat(texels),
        }
    }

    /// Puts a cell where its upper left texel is this one.
    pub(super) fn put(&mut self, baked: &Cell, corner: [u32; 2]) {
        let [across, down] = corner.map(|texels| texels as usize);
        let width = self.size[0] as usize;
        let own_width = baked.size[0] as usize;
        for at in 0..baked.alphas.len() {
            let (x, y) = (at % own_width, at / own_width);
            let texel = (down + y) * width + across + x;
            let [r, g, b] = baked.colors[at].to_array().map(srgb_byte);
            self.rgba[4 * texel..][..4].copy_from_slice(&[r, g, b, baked.alphas[at]]);
            let [x, y, z] = baked.normals[at].to_array().map(direction_byte);
            self.normals[4 * texel..][..4].copy_from_slice(&[x, y, z, 255]);
        }
    }

    /// Texture coordinates of a place in texels, right and down from the upper left corner.
    pub(super) fn uv(&self, place: Vec2) -> Vec2 {
        let [width, height] = self.size;
        place / Vec2::new(width as f32, height as f32)
    }

    /// The glTF material that draws the atlas, and reads these mips of it.
    pub(super) fn material(&self, mips: Mips) -> Material {
        material(self.size, self.rgba.clone(), self.normals.clone(), mips)
    }
}

/// A texture of normals with half as many texels a side, each the mean direction of four; the width and height of
/// what is halved are even.
pub(super) fn halved_normals(texture: &Texture) -> Texture {
    let [width, height] = [texture.width / 2, texture.height / 2];
    let direction = |x: u32, y: u32| {
        let texel = 4 * (y as usize * texture.width as usize + x as usize);
        let part = |byte: usize| f32::from(texture.rgba[texel + byte]) / 127.5 - 1.0;
        Vec3::from([0, 1, 2].map(part)).normalize_or_zero()
    };
    let mean = |at: u32| {
        let (x, y) = (2 * (at % width), 2 * (at / width));
        let four = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
        let sum: Vec3 = four.map(|(x, y)| direction(x, y)).iter().sum();
        let [x, y, z] = sum.normalize_or(Vec3::Z).to_array().map(direction_byte);
        [x, y, z, 255]
    };
    Texture {
        width,
        height,
        rgba: (0..width * height).flat_map(mean).collect(),
        ..texture.clone()
    }
}

/// What draws a texture of colours and one of normals: cut out, both sides, lit.
pub(super) fn material(
    [width, height]: [u32; 2],
    rgba: Vec<u8>,
    normals: Vec<u8>,
    mips: Mips,
) -> Material {
    let texture = |rgba: Vec<u8>| {
        Arc::new(Texture {
            width,
            height,
            rgba,
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters {
                mips,
                ..Filters::default()
            },
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

/// -1 to 1 as 0 to 255.
pub(super) fn direction_byte(x: f32) -> u8 {
    ((x.clamp(-1.0, 1.0) + 1.0) * 127.5).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_normals_are_means_of_four() {
        // Four that lean to the right and left in turn, and four that lean up.
        let [right, left, up] = [
            [255, 128, 128, 255],
            [0, 128, 128, 255],
            [128, 255, 128, 255],
        ];
        let toward = [128, 128, 255, 255];
        let rows = [[right, toward, up, up], [left, toward, up, up]];
        let texture = Texture {
            width: 4,
            height: 2,
            rgba: rows.concat().concat(),
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters::default(),
        };
        let half = halved_normals(&texture);
        assert_eq!((half.width, half.height), (2, 1));
        assert_eq!(half.rgba, [[128, 128, 255, 255], up].concat());
    }
}
