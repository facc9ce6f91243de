//! The images of materials: how large they are, and what their texels say.

use secateur_model::{Filters, Mips, Texture, Wrap};
use serde_json::Value;

use super::Document;
use super::material::base_color_texture;
use super::picture::{Decoded, Pictures};

/// An image that a material uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct MaterialImage {
    /// Its number in the file.
    pub image: usize,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Whether it is stored in blocks of 4 x 4 texels (KTX2), as a GPU keeps it: 16 bytes each.
    pub is_in_blocks: bool,
    /// Whether the sampler reads mip maps.
    pub has_mips: bool,
    /// Whether it is the base colour.
    pub is_base_color: bool,
    /// Whether it lies on the surface as the base colour does: by the same texture coordinates.
    pub lies_as_base_color: bool,
    /// What its texels are.
    pub content: TexelContent,
}

/// What the texels of an image are, by the place that a material has for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelContent {
    /// Colours: red, green and blue in sRGB, and alpha.
    Colors,
    /// Directions in tangent space: of each colour 0 to 255 for -1 to 1.
    Normals,
    /// Numbers, such as roughness and occlusion.
    Numbers,
}

impl TexelContent {
    /// As the name of a texture in a material has it, such as `normalTexture`.
    fn of(name: &str) -> Self {
        let name = name.to_ascii_lowercase();
        let is_color = ["color", "emissive", "diffuse", "specularglossiness"];
        match is_color.iter().any(|word| name.contains(word)) {
            true => Self::Colors,
            false if name.ends_with("normaltexture") => Self::Normals,
            false => Self::Numbers,
        }
    }
}

/// Calls `see` with the number of each texture that a material names, in extensions too.
pub(crate) fn for_each_texture(material: &Value, see: &mut dyn FnMut(usize)) {
    for_each_texture_info(material, &mut |_, info| see(texture_of_info(info)));
}

/// The number of the texture that a place of a material names; one that no file has where it is beyond all numbers.
fn texture_of_info(info: &Value) -> usize {
    let index = info.get("index").and_then(Value::as_u64);
    let index = index.and_then(|index| usize::try_from(index).ok());
    index.unwrap_or(usize::MAX)
}

/// Whether an entry of a material names a texture.
fn is_texture_info(name: &str, value: &Value) -> bool {
    name.ends_with("Texture") && value.get("index").is_some_and(Value::is_u64)
}

/// Calls `see` with each place of a material that names a texture, in extensions too: what it is called, and its JSON.
fn for_each_texture_info(material: &Value, see: &mut dyn FnMut(&str, &Value)) {
    let entries = material.as_object().into_iter().flatten();
    for (name, value) in entries.filter(|(name, _)| *name != "extras") {
        if is_texture_info(name, value) {
            see(name, value);
        }
        for_each_texture_info(value, see);
    }
}

/// Has a material name the texture `new` wherever it names `old`.
pub(crate) fn rename_texture(material: &mut Value, (old, new): (usize, usize)) {
    let entries = material.as_object_mut().into_iter().flatten();
    for (name, value) in entries.filter(|(name, _)| *name != "extras") {
        if is_texture_info(name, value) && texture_of_info(value) == old {
            value["index"] = new.into();
        }
        rename_texture(value, (old, new));
    }
}

impl Document {
    /// The images of a material; those that can't be decoded are left out.
    pub fn images_of_material(&self, material: usize) -> Vec<MaterialImage> {
        let materials = self.root.get("materials");
        let Some(fields) = materials.and_then(|all| all.get(material)) else {
            return Vec::new();
        };
        let base = base_color_texture(fields);
        let used_by_base = base.and_then(|info| self.texture_use(info).ok());
        let mut images = Vec::new();
        for_each_texture_info(fields, &mut |name, info| {
            let Ok(used) = self.texture_use(info) else {
                return;
            };
            let size = used.image.and_then(|image| self.image_size(image));
            if let (Some(image), Some(size)) = (used.image, size) {
                images.push(MaterialImage {
                    image,
                    size,
                    is_in_blocks: self.is_ktx2(image),
                    has_mips: used.filters.mips != Mips::None,
                    is_base_color: base.is_some_and(|base| base.get("index") == info.get("index")),
                    lies_as_base_color: used_by_base.is_some_and(|base| base.is_placed_as(&used)),
                    content: TexelContent::of(name),
                });
            }
        });
        images
    }

    /// The texels of an image, as they are in the file; nothing where it can't be decoded, or takes more memory than
    /// there is.
    pub fn image_texels(&self, image: usize) -> Option<Texture> {
        let mut pictures = Pictures::new(self, self.budget);
        let Ok(Decoded::Picture(picture)) = pictures.decoded_once(image) else {
            return None;
        };
        Some(Texture {
            width: picture.image.width(),
            height: picture.image.height(),
            rgba: picture.image.as_raw().clone(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        })
    }

    fn is_ktx2(&self, image: usize) -> bool {
        let image = self.root.get("images").and_then(|all| all.get(image));
        let text = |key| {
            image
                .and_then(|image| image.get(key)?.as_str())
                .unwrap_or("")
        };
        text("mimeType") == "image/ktx2" || text("uri").to_ascii_lowercase().ends_with(".ktx2")
    }
}
