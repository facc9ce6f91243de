//! What a stream says of its plant before the first leaf.

use secateur_model::{AlphaMode, Filters, Finish, Material, Mips, NormalMap, Texture, Wrap};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The longest side of a picture, in texels.
const MAX_SIDE: u32 = 2048;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) name: String,
    /// How many leaves the original has.
    pub(super) leaves: u32,
    pub(super) triangles: u64,
    /// Of the removal order, all of which are made at first.
    pub(super) steps: u32,
    /// Up to this name parts are original leaves.
    pub(super) leaf_names: u32,
    pub(super) pieces: u32,
    pub(super) order_sha256: String,
    /// Corners of the box about the original, and how far it reaches from the box's upright axis.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    pub(super) reach: f64,
    pub(super) textures: Vec<Picture>,
    pub(super) materials: Vec<Look>,
    pub(super) surfaces: Vec<SurfaceHead>,
}

/// A picture among the bytes of all, and its sampler.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Picture {
    at: usize,
    length: usize,
    is_srgb: bool,
    wrap: [WrapName; 2],
    is_smooth_near: bool,
    is_smooth_far: bool,
    mips: MipsName,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum WrapName {
    Repeat,
    Clamp,
    Mirror,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum MipsName {
    None,
    Nearest,
    Blended,
}

/// A material as a stream carries it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Look {
    #[serde(default)]
    pub(super) name: String,
    color: [f32; 4],
    texture: Option<usize>,
    alpha: AlphaName,
    cutoff: f32,
    is_double_sided: bool,
    roughness: f32,
    is_unlit: bool,
    normal_map: Option<usize>,
    normal_scale: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum AlphaName {
    Opaque,
    Mask,
    Blend,
}

/// A surface: its material, and what its vertices have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SurfaceHead {
    pub(super) material: usize,
    pub(super) is_foliage: bool,
    pub(super) normals: bool,
    pub(super) uvs: bool,
    pub(super) colors: bool,
    pub(super) holds: bool,
}

impl Picture {
    /// The texture, decoded; nothing where the bytes are no picture or one that is too large.
    fn texture(&self, pictures: &[u8]) -> Option<Texture> {
        let end = self.at.checked_add(self.length)?;
        let png = pictures.get(self.at..end)?;
        let mut reader =
            image::ImageReader::with_format(std::io::Cursor::new(png), image::ImageFormat::Png);
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        limits.max_alloc = Some(64 << 20);
        reader.limits(limits);
        let decoded = reader.decode().ok()?.into_rgba8();
        Some(Texture {
            width: decoded.width(),
            height: decoded.height(),
            rgba: decoded.into_raw(),
            wrap: self.wrap.map(|wrap| match wrap {
                WrapName::Repeat => Wrap::Repeat,
                WrapName::Clamp => Wrap::ClampToEdge,
                WrapName::Mirror => Wrap::MirroredRepeat,
            }),
            filters: Filters {
                is_smooth_near: self.is_smooth_near,
                is_smooth_far: self.is_smooth_far,
                mips: match self.mips {
                    MipsName::None => Mips::None,
                    MipsName::Nearest => Mips::Nearest,
                    MipsName::Blended => Mips::Blended,
                },
            },
        })
    }
}

impl Look {
    fn material(&self, textures: &[Arc<Texture>]) -> Option<Material> {
        let texture = |number: usize| textures.get(number).map(Arc::clone);
        let is_finite = [
            &self.color[..],
            &[self.cutoff, self.roughness, self.normal_scale],
        ]
        .concat()
        .iter()
        .all(|x| x.is_finite());
        if !is_finite {
            return None;
        }
        let normal_map = match self.normal_map {
            None => None,
            Some(number) => Some(NormalMap {
                texture: texture(number)?,
                scale: self.normal_scale,
            }),
        };
        Some(Material {
            name: self.name.clone(),
            base_color: self.color,
            texture: match self.texture {
                None => None,
                Some(number) => Some(texture(number)?),
            },
            alpha_mode: match self.alpha {
                AlphaName::Opaque => AlphaMode::Opaque,
                AlphaName::Mask => AlphaMode::Mask(self.cutoff),
                AlphaName::Blend => AlphaMode::Blend,
            },
            double_sided: self.is_double_sided,
            finish: Finish {
                roughness: self.roughness,
                is_unlit: self.is_unlit,
                normal_map,
            },
        })
    }
}

impl Head {
    /// The materials of its surfaces, or what is wrong with them.
    pub(super) fn materials(&self, pictures: &[u8]) -> Result<Vec<Arc<Material>>, &'static str> {
        let textures = self
            .textures
            .iter()
            .map(|p| p.texture(pictures).map(Arc::new));
        let textures: Option<Vec<_>> = textures.collect();
        let textures = textures.ok_or("one of its pictures cannot be read")?;
        let materials = self.materials.iter().map(|look| look.material(&textures));
        let materials: Option<Vec<Material>> = materials.collect();
        let materials = materials.ok_or("a material names a picture that is not there")?;
        let materials: Vec<Arc<Material>> = materials.into_iter().map(Arc::new).collect();
        let of_surface = |surface: &SurfaceHead| materials.get(surface.material).map(Arc::clone);
        let of_surfaces: Option<Vec<_>> = self.surfaces.iter().map(of_surface).collect();
        of_surfaces.ok_or("a surface names a material that is not there")
    }
}
