//! What a stream says of its plant before the first leaf.

use std::io::Cursor;
use std::sync::Arc;

use image::{ImageFormat, ImageReader};
use secateur_model::{AlphaMode, Filters, Finish, Material, Mips, NormalMap, Texture, Wrap};
use serde::{Deserialize, Serialize};

/// The longest side of a picture, in texels.
const MAX_SIDE: u32 = 2048;

/// The most bytes of all pictures of a stream, decoded: 32 of the largest.
const MAX_DECODED: u64 = 512 << 20;

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
    fn reader<'p>(&self, pictures: &'p [u8]) -> Option<ImageReader<Cursor<&'p [u8]>>> {
        let end = self.at.checked_add(self.length)?;
        let png = pictures.get(self.at..end)?;
        Some(ImageReader::with_format(Cursor::new(png), ImageFormat::Png))
    }

    /// How many bytes the texture takes, as the picture's header has it.
    fn decoded_bytes(&self, pictures: &[u8]) -> Option<u64> {
        let (width, height) = self.reader(pictures)?.into_dimensions().ok()?;
        Some(4 * u64::from(width) * u64::from(height))
    }

    /// The texture, decoded; nothing where the bytes are no picture or one that is too large.
    fn texture(&self, pictures: &[u8]) -> Option<Texture> {
        let mut reader = self.reader(pictures)?;
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
        let unreadable = "one of its pictures cannot be read";
        let mut decoded = 0;
        for picture in &self.textures {
            decoded += picture.decoded_bytes(pictures).ok_or(unreadable)?;
            if decoded > MAX_DECODED {
                return Err("its pictures take more than 512 MiB when decoded");
            }
        }
        let textures = self
            .textures
            .iter()
            .map(|p| p.texture(pictures).map(Arc::new));
        let textures: Option<Vec<_>> = textures.collect();
        let textures = textures.ok_or(unreadable)?;
        let materials = self.materials.iter().map(|look| look.material(&textures));
        let materials: Option<Vec<Material>> = materials.collect();
        let materials = materials.ok_or("a material names a picture that is not there")?;
        let materials: Vec<Arc<Material>> = materials.into_iter().map(Arc::new).collect();
        let of_surface = |surface: &SurfaceHead| materials.get(surface.material).map(Arc::clone);
        let of_surfaces: Option<Vec<_>> = self.surfaces.iter().map(of_surface).collect();
        of_surfaces.ok_or("a surface names a material that is not there")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of few bytes may be named many times, and is decoded each time.
    #[test]
    fn pictures_that_take_too_much_are_refused_before_they_are_decoded() {
        let mut png = Cursor::new(Vec::new());
        let picture = image::GrayImage::new(MAX_SIDE, MAX_SIDE);
        picture.write_to(&mut png, ImageFormat::Png).unwrap();
        let png = png.into_inner();
        let picture = Picture {
            at: 0,
            length: png.len(),
            is_srgb: true,
            wrap: [WrapName::Repeat; 2],
            is_smooth_near: true,
            is_smooth_far: true,
            mips: MipsName::Blended,
        };
        let head = |count| Head {
            name: String::new(),
            leaves: 0,
            triangles: 0,
            steps: 0,
            leaf_names: 0,
            pieces: 0,
            order_sha256: String::new(),
            low: [0.0; 3],
            high: [0.0; 3],
            reach: 0.0,
            textures: vec![picture.clone(); count],
            materials: Vec::new(),
            surfaces: Vec::new(),
        };
        assert!(head(2).materials(&png).is_ok());
        let refused = head(33).materials(&png).unwrap_err();
        assert!(refused.contains("512 MiB"), "{refused}");
    }
}
