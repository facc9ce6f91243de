//! Textured triangles as a renderer wants them: what a tree looks like.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

use crate::{Hold, Wrap};

/// How a sampler filters (glTF `magFilter` and `minFilter`); smooth in every way
/// where the file does not say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Filters {
    /// Near by, texels blend into each other; else each is a block.
    pub is_smooth_near: bool,
    /// Far off, texels of a mip level blend into each other.
    pub is_smooth_far: bool,
    /// What is done between mip levels.
    pub mips: Mips,
}

impl Default for Filters {
    fn default() -> Self {
        Self {
            is_smooth_near: true,
            is_smooth_far: true,
            mips: Mips::Blended,
        }
    }
}

/// Which mip levels a sampler reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mips {
    /// Only the image itself.
    None,
    /// The one level whose texels are nearest to a pixel in size.
    Nearest,
    /// The two nearest, blended.
    Blended,
}

/// An image with its sampler.
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
    /// How it is filtered.
    pub filters: Filters,
}

/// What a material does with alpha (glTF `alphaMode`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// The surface is opaque; its alpha is ignored.
    Opaque,
    /// A texel whose alpha is below this cutoff (0 to 1) is not there.
    Mask(f32),
    /// Alpha blends with what is behind.
    Blend,
}

/// What a material does with light, beside its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Finish {
    /// From 0, a mirror, to 1, matt (glTF `roughnessFactor`).
    pub roughness: f32,
    /// Light does not change its colour (KHR_materials_unlit).
    pub is_unlit: bool,
    /// Bends the shading normals.
    pub normal_map: Option<NormalMap>,
}

impl Default for Finish {
    fn default() -> Self {
        Self {
            roughness: 1.0,
            is_unlit: false,
            normal_map: None,
        }
    }
}

/// A normal map in tangent space (glTF `normalTexture`), read by the same
/// texture coordinates as the base colour.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    /// Red is along u, green against v, blue along the normal, 0 to 255 for -1
    /// to 1.
    pub texture: Arc<Texture>,
    /// What red and green are multiplied with.
    pub scale: f32,
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
    /// Whether alpha is ignored, cuts out or blends.
    pub alpha_mode: AlphaMode,
    /// Whether back faces are drawn.
    pub double_sided: bool,
    /// What it does with light.
    pub finish: Finish,
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
    /// What each position hangs on, in world space, for shaders that sway it: one per position, or
    /// empty.
    pub holds: Vec<Hold>,
    /// Corners of each triangle, as indices into the above.
    pub triangles: Vec<[u32; 3]>,
    /// Colour, texture, alpha and finish of all its triangles.
    pub material: Arc<Material>,
}

impl Surface {
    /// A surface of this material without triangles.
    pub fn empty(material: Arc<Material>) -> Self {
        Self {
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: Vec::new(),
            material,
        }
    }
}
