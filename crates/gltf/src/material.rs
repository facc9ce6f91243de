//! Materials: what of them decides how a leaf looks.

use glam::DVec2;
use serde_json::Value;

use super::Document;
use super::error::{At, Fault, Problem};
use super::property;
use secateur_model::{AlphaMode, Filters, Mips, Wrap};

/// The base colour, alpha and sides of a material.
#[derive(Clone, Debug)]
pub(crate) struct MaterialLook {
    /// Index in `materials`, or `None` for glTF's default material.
    pub(crate) material: Option<usize>,
    /// Its name, or empty.
    pub(crate) name: String,
    pub(crate) alpha_mode: AlphaMode,
    /// Linear colour and alpha.
    pub(crate) base_color: [f32; 4],
    pub(crate) texture: Option<TextureUse>,
    pub(crate) double_sided: bool,
    pub(crate) roughness: f32,
    pub(crate) is_unlit: bool,
    /// Whether its colour is what it emits: vertex colours do not count then.
    pub(crate) is_emission: bool,
    /// Its normal map, and what scales it. Only looks: a broken one is left out.
    pub(crate) normal_map: Option<(TextureUse, f32)>,
}

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextureUse {
    /// Index in `images`, or `None` where the file names no image, only one in the format of an
    /// extension that is not known.
    pub(crate) image: Option<usize>,
    pub(crate) wrap: [Wrap; 2],
    pub(crate) filters: Filters,
    /// The `n` of `TEXCOORD_n`.
    pub(crate) uv_set: usize,
    pub(crate) transform: UvTransform,
}

impl TextureUse {
    /// Whether a texture coordinate finds the same place in both.
    pub(crate) fn is_placed_as(&self, other: &Self) -> bool {
        (self.uv_set, self.transform) == (other.uv_set, other.transform)
    }
}

/// KHR_texture_transform: scale, then rotation, then offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UvTransform {
    offset: DVec2,
    /// The angle in radians, counter-clockwise on the image.
    rotation: f64,
    scale: DVec2,
}

impl UvTransform {
    const IDENTITY: Self = Self {
        offset: DVec2::ZERO,
        rotation: 0.0,
        scale: DVec2::ONE,
    };

    /// The transformed texture coordinate. v points down, so that turning
    /// counter-clockwise takes u to -v.
    pub(crate) fn apply(&self, uv: DVec2) -> DVec2 {
        if *self == Self::IDENTITY {
            return uv;
        }
        let (sin, cos) = self.rotation.sin_cos();
        let scaled = uv * self.scale;
        let turned = DVec2::new(
            cos * scaled.x + sin * scaled.y,
            cos * scaled.y - sin * scaled.x,
        );
        self.offset + turned
    }
}

impl Document {
    /// The look of a primitive's material.
    pub(crate) fn look(&self, mesh: usize, primitive: usize) -> Result<MaterialLook, Fault> {
        let json = self.primitive(mesh, primitive)?;
        let place = || self.primitive_place(mesh, primitive);
        let Some(index) = property::index(json, "material").at(place)? else {
            return Ok(MaterialLook {
                material: None,
                name: String::new(),
                alpha_mode: AlphaMode::Opaque,
                base_color: [1.0; 4],
                texture: None,
                double_sided: false,
                roughness: 1.0,
                is_unlit: false,
                is_emission: false,
                normal_map: None,
            });
        };
        let json = property::entry(&self.root, "materials", index).at(place)?;
        self.read_look(index, json)
            .at(|| self.place("materials", index))
    }

    fn read_look(&self, index: usize, json: &Value) -> Result<MaterialLook, Problem> {
        const NONE: Value = Value::Null;
        let pbr = json.get("pbrMetallicRoughness").unwrap_or(&NONE);
        let color_from = ColorFrom::of(json);
        let color = match color_from {
            ColorFrom::Base => property::numbers::<4>(pbr, "baseColorFactor")?,
            ColorFrom::Diffuse => match property::extension(json, GLOSSY) {
                Some(glossy) => property::numbers::<4>(glossy, "diffuseFactor")?,
                None => None,
            },
            ColorFrom::Emission => emissive_factor(json).map(|[r, g, b]| [r, g, b, 1.0]),
        };
        let color = color.unwrap_or([1.0; 4]);
        let texture = base_color_texture(json);
        let is_emission = color_from == ColorFrom::Emission;
        Ok(MaterialLook {
            material: Some(index),
            name: property::text(json, "name")?.unwrap_or("").to_owned(),
            // An emission's alpha is read by no client.
            alpha_mode: match is_emission {
                true => AlphaMode::Opaque,
                false => alpha_mode(json)?,
            },
            base_color: color.map(|c| c as f32),
            texture: texture.map(|t| self.texture_use(t)).transpose()?,
            double_sided: property::flag(json, "doubleSided")?,
            roughness: number_or(pbr, "roughnessFactor", 1.0).clamp(0.0, 1.0),
            is_unlit: is_emission || property::extension(json, "KHR_materials_unlit").is_some(),
            is_emission,
            normal_map: json.get("normalTexture").and_then(|info| {
                let texture = self.texture_use(info).ok()?;
                Some((texture, number_or(info, "scale", 1.0)))
            }),
        })
    }

    pub(crate) fn texture_use(&self, info: &Value) -> Result<TextureUse, Problem> {
        let index = property::required_index(info, "index")?;
        let texture = property::entry(&self.root, "textures", index)?;
        let transform = property::extension(info, "KHR_texture_transform");
        let uv_set = match transform {
            Some(transform) => property::index(transform, "texCoord")?,
            None => None,
        };
        let uv_set = match uv_set {
            Some(set) => set,
            None => property::index(info, "texCoord")?.unwrap_or(0),
        };
        let image = image_of(texture)?;
        if let Some(image) = image {
            property::entry(&self.root, "images", image)?;
        }
        Ok(TextureUse {
            image,
            wrap: self.wrap(texture)?,
            filters: self.filters(texture),
            uv_set,
            transform: transform.map_or(Ok(UvTransform::IDENTITY), uv_transform)?,
        })
    }

    fn wrap(&self, texture: &Value) -> Result<[Wrap; 2], Problem> {
        let Some(index) = property::index(texture, "sampler")? else {
            return Ok([Wrap::Repeat; 2]);
        };
        let sampler = property::entry(&self.root, "samplers", index)?;
        Ok([wrap_mode(sampler, "wrapS")?, wrap_mode(sampler, "wrapT")?])
    }

    /// Only looks depend on filters: what cannot be read is the default.
    fn filters(&self, texture: &Value) -> Filters {
        const NEAREST: u64 = 9728;
        let sampler = texture.get("sampler").and_then(Value::as_u64);
        let sampler = sampler.and_then(|index| self.root.get("samplers")?.get(index as usize));
        let filter = |name| sampler?.get(name)?.as_u64();
        let (is_smooth_far, mips) = match filter("minFilter") {
            Some(NEAREST) => (false, Mips::None),
            Some(9729) => (true, Mips::None),
            Some(9984) => (false, Mips::Nearest),
            Some(9985) => (true, Mips::Nearest),
            Some(9986) => (false, Mips::Blended),
            _ => (true, Mips::Blended),
        };
        Filters {
            is_smooth_near: filter("magFilter") != Some(NEAREST),
            is_smooth_far,
            mips,
        }
    }
}

/// The image of a texture: the first of those that can be decoded, or one that can't, so that it is said.
fn image_of(texture: &Value) -> Result<Option<usize>, Problem> {
    let in_extension = |name: &str| match property::extension(texture, name) {
        Some(other) => property::index(other, "source"),
        None => Ok(None),
    };
    if let Some(webp) = in_extension("EXT_texture_webp")? {
        return Ok(Some(webp));
    }
    if let Some(plain) = property::index(texture, "source")? {
        return Ok(Some(plain));
    }
    for name in ["KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"] {
        if let Some(other) = in_extension(name)? {
            return Ok(Some(other));
        }
    }
    Ok(None)
}

/// How a material names its base colour texture.
pub(crate) fn base_color_texture(material: &Value) -> Option<&Value> {
    material.pointer(base_color_pointer(material))
}

/// Where a material names its base colour texture, as a JSON pointer.
pub(crate) fn base_color_pointer(material: &Value) -> &'static str {
    match ColorFrom::of(material) {
        ColorFrom::Base => BASE_COLOR_TEXTURE,
        ColorFrom::Diffuse => "/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture",
        ColorFrom::Emission => EMISSIVE_TEXTURE,
    }
}

/// The extension whose diffuse colour is a base colour of another name.
const GLOSSY: &str = "KHR_materials_pbrSpecularGlossiness";

/// Where a material of no such extension has its base colour texture.
const BASE_COLOR_TEXTURE: &str = "/pbrMetallicRoughness/baseColorTexture";

const EMISSIVE_TEXTURE: &str = "/emissiveTexture";

/// The linear base colour, of 1, below which a material is black but for what it emits.
const BLACK: f64 = 0.02;

/// What of a material a client shows as its colour.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ColorFrom {
    /// The base colour of metallic-roughness, as in most files.
    Base,
    /// The diffuse colour of the extension. Where a material has a texture for both, the base colour is read, which
    /// clients without the extension draw too.
    Diffuse,
    /// The emission of a black material, as scans are exported whose light is in their texture.
    Emission,
}

impl ColorFrom {
    fn of(material: &Value) -> Self {
        let has = |pointer| material.pointer(pointer).is_some();
        if has(BASE_COLOR_TEXTURE) {
            return Self::Base;
        }
        if property::extension(material, GLOSSY).is_some() {
            return Self::Diffuse;
        }
        let factor = material.pointer("/pbrMetallicRoughness/baseColorFactor");
        let factor = factor.and_then(Value::as_array);
        let is_black = factor.is_some_and(|factor| {
            let channels = factor.iter().take(3).filter_map(Value::as_f64);
            channels.fold(0.0, f64::max) < BLACK
        });
        let emits = emissive_factor(material).is_some_and(|rgb| rgb.iter().any(|c| *c > BLACK));
        match is_black && emits {
            true => Self::Emission,
            false => Self::Base,
        }
    }
}

/// What a material emits, in linear light; what is brighter than white is white. None where it says nothing.
fn emissive_factor(material: &Value) -> Option<[f64; 3]> {
    let factor = property::numbers::<3>(material, "emissiveFactor").ok()??;
    let strength = property::extension(material, "KHR_materials_emissive_strength");
    let strength = strength.map_or(1.0, |json| number_or(json, "emissiveStrength", 1.0));
    Some(factor.map(|c| (c * f64::from(strength)).clamp(0.0, 1.0)))
}

/// A number that only looks depend on: what cannot be read is the default.
fn number_or(json: &Value, name: &str, default: f32) -> f32 {
    json.get(name)
        .and_then(Value::as_f64)
        .map_or(default, |n| n as f32)
}

fn wrap_mode(sampler: &Value, name: &'static str) -> Result<Wrap, Problem> {
    match property::whole(sampler, name)? {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33071) => Ok(Wrap::ClampToEdge),
        Some(33648) => Ok(Wrap::MirroredRepeat),
        Some(other) => Err(Problem::BadProperty {
            property: name,
            expected: "one of 10497, 33071 and 33648",
            found: other.to_string(),
        }),
    }
}

fn uv_transform(json: &Value) -> Result<UvTransform, Problem> {
    let identity = UvTransform::IDENTITY;
    Ok(UvTransform {
        offset: property::numbers(json, "offset")?.map_or(identity.offset, DVec2::from_array),
        rotation: property::number(json, "rotation")?.unwrap_or(identity.rotation),
        scale: property::numbers(json, "scale")?.map_or(identity.scale, DVec2::from_array),
    })
}

fn alpha_mode(json: &Value) -> Result<AlphaMode, Problem> {
    const DEFAULT_CUTOFF: f64 = 0.5;
    match property::text(json, "alphaMode")? {
        None | Some("OPAQUE") => Ok(AlphaMode::Opaque),
        Some("BLEND") => Ok(AlphaMode::Blend),
        Some("MASK") => {
            let cutoff = property::number(json, "alphaCutoff")?.unwrap_or(DEFAULT_CUTOFF);
            Ok(AlphaMode::Mask(cutoff as f32))
        }
        Some(other) => Err(Problem::BadProperty {
            property: "alphaMode",
            expected: "OPAQUE, MASK or BLEND",
            found: super::error::shortened(other),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_takes_the_lower_left_quadrant() {
        // The extension's own example: offset (0, 1), a quarter turn, scale 0.5
        // shows the lower left quadrant. v points down, so that is u in
        // 0..0.5 and v in 0.5..1.
        let transform = UvTransform {
            offset: DVec2::new(0.0, 1.0),
            rotation: std::f64::consts::FRAC_PI_2,
            scale: DVec2::splat(0.5),
        };
        let near = |a: DVec2, b: DVec2| (a - b).length() < 1e-15;
        let at = |u, v| transform.apply(DVec2::new(u, v));
        assert!(near(at(0.0, 0.0), DVec2::new(0.0, 1.0)));
        assert!(near(at(1.0, 0.0), DVec2::new(0.0, 0.5)));
        assert!(near(at(0.0, 1.0), DVec2::new(0.5, 1.0)));
    }
}
