//! Textured triangles as a renderer wants them: what a tree looks like.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::Wrap;

/// An image with its sampler's wrapping.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// sRGB colour and linear alpha, four bytes a texel, row by row from the top.
    pub rgba: Vec<u8>,
    /// How u and v wrap.
    pub wrap: [Wrap; 2],
}

/// What a material does with alpha (glTF `alphaMode`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// A texel whose alpha is below this cutoff (0 to 1) is not there.
    Mask(f32),
    /// Alpha blends with what is behind.
    Blend,
}

/// The part of a glTF material that a plain render needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file, or empty.
    pub name: String,
    /// Linear base colour and alpha, multiplied with the texture.
    pub base_color: [f32; 4],
    /// The base colour texture.
    pub texture: Option<Arc<Texture>>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Whether back faces are drawn.
    pub double_sided: bool,
}

/// An indexed triangle mesh in world space with one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// World-space positions.
    pub positions: Vec<DVec3>,
    /// Shading normals, unit length, one per position; they may be far from the
    /// faces' own. Empty where the file has none.
    pub normals: Vec<Vec3>,
    /// Texture coordinates after any texture transform, one per position, or
    /// empty.
    pub uvs: Vec<Vec2>,
    /// Linear vertex colours, one per position, or empty.
    pub colors: Vec<Vec4>,
    /// Corners of each triangle, as indices into the above.
    pub triangles: Vec<[u32; 3]>,
    /// How it looks.
    pub material: Arc<Material>,
}
