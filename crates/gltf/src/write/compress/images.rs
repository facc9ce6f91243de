//! Images of a file in formats of fewer bytes: PNG as lossless WebP, and colours as KTX2.

use std::io::Cursor;

use image::codecs::webp::WebPEncoder;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use serde_json::{Value, json};

use super::super::draft::Draft;
use super::super::drop_unreferenced::remove_field;
use super::super::files::ImageFormat as Format;
use super::super::references::{as_index, items, knows_all_extensions, len};
use super::need_extension;
use crate::error::Fault;

/// The part of an image's bytes that WebP must save: not every client reads the extension.
const LEAST_SAVED: usize = 20;

/// The most bytes that an image may take while it is written anew.
const MOST_BYTES: u64 = 512 << 20;

/// An image in another format.
struct Encoded {
    bytes: Vec<u8>,
    mime: &'static str,
    /// The extension by which a texture names it.
    extension: &'static str,
}

/// Gives images in buffer views this format: as WebP PNG alone, where it is enough smaller, and as KTX2 those that
/// have colours alone. Textures that have a copy in another format already, and images of 16 bits a channel, stay
/// as they are.
pub(super) fn encode(draft: &mut Draft, format: Format) -> Result<(), Fault> {
    if !knows_all_extensions(&draft.root) {
        return Ok(());
    }
    for number in 0..len(&draft.root, "images") {
        let image = &draft.root["images"][number];
        let view = image.get("bufferView").and_then(as_index);
        let is_png = image.get("mimeType").and_then(Value::as_str) == Some("image/png");
        let Some(view) = view.filter(|_| is_plain(&draft.root, number)) else {
            continue;
        };
        let mut encoded = match format {
            Format::WebP => None,
            #[cfg(feature = "ktx2")]
            Format::Ktx2 => ktx2(draft, number),
        };
        if encoded.is_none() && is_png {
            encoded = webp(draft, view)?;
        }
        let Some(encoded) = encoded else {
            continue;
        };
        let view = draft.push_bytes(encoded.bytes);
        let image = &mut draft.root["images"][number];
        image["bufferView"] = view.into();
        image["mimeType"] = encoded.mime.into();
        for texture in items(&mut draft.root, "textures") {
            if texture.get("source").and_then(as_index) == Some(number) {
                remove_field(texture, "source");
                texture["extensions"] = json!({encoded.extension: {"source": number}});
            }
        }
        need_extension(&mut draft.root, encoded.extension);
    }
    Ok(())
}

/// Whether textures name an image, and all that do name nothing else.
fn is_plain(root: &Value, image: usize) -> bool {
    let textures = root.get("textures").and_then(Value::as_array);
    let uses = |texture: &&Value| super::super::base_color::sources(texture).contains(&image);
    let mut users = textures.into_iter().flatten().filter(uses).peekable();
    users.peek().is_some() && users.all(|texture| texture.get("extensions").is_none())
}

/// A PNG as lossless WebP, if that is enough smaller.
fn webp(draft: &Draft, view: usize) -> Result<Option<Encoded>, Fault> {
    let png = draft.document.view_bytes(view)?;
    Ok(smaller(&png).map(|bytes| Encoded {
        bytes,
        mime: "image/webp",
        extension: "EXT_texture_webp",
    }))
}

/// An image as KTX2, if materials show it as colours and as nothing else.
#[cfg(feature = "ktx2")]
fn ktx2(draft: &Draft, image: usize) -> Option<Encoded> {
    let document = draft.document;
    let materials = 0..draft.root.get("materials")?.as_array()?.len();
    let uses = materials.flat_map(|material| document.images_of_material(material));
    let mut uses = uses.filter(|used| used.image == image).peekable();
    uses.peek()?;
    if !uses.all(|used| used.content == crate::TexelContent::Colors) {
        return None;
    }
    let texels = document.image_texels(image)?;
    let texels = image::RgbaImage::from_raw(texels.width, texels.height, texels.rgba)?;
    Some(Encoded {
        bytes: secateur_ktx2::etc1s(&texels)?,
        mime: "image/ktx2",
        extension: "KHR_texture_basisu",
    })
}

/// The texels of a PNG as WebP, if that is enough smaller.
fn smaller(png: &[u8]) -> Option<Vec<u8>> {
    let mut reader = ImageReader::with_format(Cursor::new(png), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let image = reader.decode().ok()?;
    let is_whole = matches!(
        image,
        DynamicImage::ImageLuma8(_)
            | DynamicImage::ImageLumaA8(_)
            | DynamicImage::ImageRgb8(_)
            | DynamicImage::ImageRgba8(_)
    );
    let mut bytes = Vec::new();
    let written = is_whole.then(|| image.write_with_encoder(WebPEncoder::new_lossless(&mut bytes)));
    written?.ok()?;
    (bytes.len() < png.len() - png.len() / LEAST_SAVED).then_some(bytes)
}
