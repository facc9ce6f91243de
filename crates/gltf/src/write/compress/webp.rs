//! PNG images of a file as lossless WebP: the same texels in fewer bytes.

use std::io::Cursor;

use image::codecs::webp::WebPEncoder;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use serde_json::{Value, json};

use super::super::draft::Draft;
use super::super::drop_unreferenced::remove_field;
use super::super::references::{as_index, items, knows_all_extensions, len};
use super::need_extension;
use crate::error::Fault;

/// The extension by which a texture names such an image.
const NAME: &str = "EXT_texture_webp";

/// The part of an image's bytes that must be saved: not every client reads the extension.
const LEAST_SAVED: usize = 20;

/// The most bytes that an image may take while it is written anew.
const MOST_BYTES: u64 = 512 << 20;

/// Gives PNG images in buffer views this format, where it is enough smaller. Textures that have a copy in another
/// one already, and images of 16 bits a channel, stay as they are.
pub(super) fn images(draft: &mut Draft) -> Result<(), Fault> {
    if !knows_all_extensions(&draft.root) {
        return Ok(());
    }
    for number in 0..len(&draft.root, "images") {
        let image = &draft.root["images"][number];
        let view = image.get("bufferView").and_then(as_index);
        let is_png = image.get("mimeType").and_then(Value::as_str) == Some("image/png");
        let Some(view) = view.filter(|_| is_png && is_plain(&draft.root, number)) else {
            continue;
        };
        let Some(bytes) = smaller(&draft.document.view_bytes(view)?) else {
            continue;
        };
        let view = draft.push_image(bytes);
        let image = &mut draft.root["images"][number];
        image["bufferView"] = view.into();
        image["mimeType"] = "image/webp".into();
        for texture in items(&mut draft.root, "textures") {
            if texture.get("source").and_then(as_index) == Some(number) {
                remove_field(texture, "source");
                texture["extensions"] = json!({NAME: {"source": number}});
            }
        }
        need_extension(&mut draft.root, NAME);
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
