//! Textures as a browser reads them, each once however many levels use it.

use std::borrow::Cow;
use std::io::Cursor;
use std::sync::Arc;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use secateur_model::{Mips, Texture, Wrap};
use serde::Serialize;

use super::PreviewError;

/// The longest side that goes into a page, in texels: more than a window shows
/// of a tree. Larger images are halved until they fit.
const MAX_SIDE: u32 = 2048;

/// How textures are handed to who draws them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pictures {
    /// As PNG files: small, for pages that are kept.
    #[default]
    Png,
    /// As texels of four bytes: at once, for who draws them in the same process.
    Texels,
}

/// Textures of a page, and the bytes of their pictures one after another.
#[derive(Default)]
pub(crate) struct Textures {
    known: Vec<Known>,
    pub(crate) bytes: Vec<u8>,
    kind: Pictures,
}

struct Known {
    texture: Arc<Texture>,
    entry: Entry,
}

/// A texture as the page's script wants it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Entry {
    /// Of its picture in the bytes, and how many.
    at: usize,
    length: usize,
    /// Width and height in texels, where the picture is texels.
    #[serde(skip_serializing_if = "Option::is_none")]
    texels: Option<[u32; 2]>,
    /// Colours are sRGB, normals are not.
    is_srgb: bool,
    wrap: [&'static str; 2],
    is_smooth_near: bool,
    is_smooth_far: bool,
    mips: &'static str,
}

impl Textures {
    pub(crate) fn of(kind: Pictures) -> Self {
        Self {
            kind,
            ..Self::default()
        }
    }

    /// The number of a texture, which is packed when it is new.
    pub(crate) fn number(
        &mut self,
        texture: &Arc<Texture>,
        is_srgb: bool,
    ) -> Result<usize, PreviewError> {
        let is_same = |known: &Known| {
            known.entry.is_srgb == is_srgb
                && (Arc::ptr_eq(&known.texture, texture) || known.texture == *texture)
        };
        if let Some(known) = self.known.iter().position(is_same) {
            return Ok(known);
        }
        let at = self.bytes.len();
        let fitted = Fitted::of(texture);
        let texels = match self.kind {
            Pictures::Png => {
                let png = fitted.encoded().map_err(|error| PreviewError::Texture {
                    width: texture.width,
                    height: texture.height,
                    reason: error.to_string(),
                })?;
                self.bytes.extend(&png);
                None
            }
            Pictures::Texels => {
                self.bytes.extend(fitted.rgba.as_ref());
                Some([fitted.width, fitted.height])
            }
        };
        let filters = texture.filters;
        self.known.push(Known {
            texture: Arc::clone(texture),
            entry: Entry {
                at,
                length: self.bytes.len() - at,
                texels,
                is_srgb,
                wrap: texture.wrap.map(|wrap| match wrap {
                    Wrap::Repeat => "repeat",
                    Wrap::ClampToEdge => "clamp",
                    Wrap::MirroredRepeat => "mirror",
                }),
                is_smooth_near: filters.is_smooth_near,
                is_smooth_far: filters.is_smooth_far,
                mips: match filters.mips {
                    Mips::None => "none",
                    Mips::Nearest => "nearest",
                    Mips::Blended => "blended",
                },
            },
        });
        Ok(self.known.len() - 1)
    }

    pub(crate) fn entries(&self) -> Vec<Entry> {
        self.known.iter().map(|known| known.entry.clone()).collect()
    }
}

/// A texture, halved until it fits into a page.
struct Fitted<'t> {
    rgba: Cow<'t, [u8]>,
    width: u32,
    height: u32,
}

impl<'t> Fitted<'t> {
    fn of(texture: &'t Texture) -> Self {
        let mut fitted = Self {
            rgba: Cow::Borrowed(&texture.rgba),
            width: texture.width,
            height: texture.height,
        };
        while fitted.width.max(fitted.height) > MAX_SIDE {
            fitted = Self {
                rgba: Cow::Owned(half(&fitted.rgba, fitted.width, fitted.height)),
                width: (fitted.width / 2).max(1),
                height: (fitted.height / 2).max(1),
            };
        }
        fitted
    }

    /// PNG, since colours under an alpha of zero must stay: mip maps mix them in.
    fn encoded(&self) -> Result<Vec<u8>, image::ImageError> {
        let (width, height) = (self.width, self.height);
        let mut file = Cursor::new(Vec::new());
        let encoder =
            PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive);
        let texels = || self.rgba.chunks_exact(4);
        if texels().all(|texel| texel[3] == u8::MAX) {
            let rgb: Vec<u8> = texels().flat_map(|t| [t[0], t[1], t[2]]).collect();
            encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8)?;
        } else {
            encoder.write_image(&self.rgba, width, height, ExtendedColorType::Rgba8)?;
        }
        Ok(file.into_inner())
    }
}

/// The means of two by two texels, byte by byte; an odd last row or column is
/// left out.
fn half(rgba: &[u8], width: u32, height: u32) -> Vec<u8> {
    let (across, down) = ((width / 2).max(1), (height / 2).max(1));
    let mut smaller = Vec::with_capacity(4 * across as usize * down as usize);
    for y in 0..down {
        for x in 0..across {
            for channel in 0..4 {
                let byte = |dx: u32, dy: u32| {
                    let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                    let texel = y as usize * width as usize + x as usize;
                    u32::from(rgba[4 * texel + channel])
                };
                let sum = byte(0, 0) + byte(1, 0) + byte(0, 1) + byte(1, 1);
                smaller.push(((sum + 2) / 4) as u8);
            }
        }
    }
    smaller
}

#[cfg(test)]
mod tests {
    use secateur_model::Filters;

    use super::*;

    fn texture(width: u32, height: u32, alpha: u8) -> Arc<Texture> {
        Arc::new(Texture {
            width,
            height,
            rgba: [10, 20, 30, alpha].repeat(width as usize * height as usize),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        })
    }

    #[test]
    fn a_texture_that_levels_share_is_packed_once() {
        let mut textures = Textures::default();
        let mut number = |texture, is_srgb| textures.number(&texture, is_srgb).unwrap();
        assert_eq!(number(texture(2, 2, 255), true), 0);
        assert_eq!(number(texture(2, 2, 0), true), 1);
        // Read again from another level's file.
        assert_eq!(number(texture(2, 2, 255), true), 0);
        // As normals these bytes are another texture.
        assert_eq!(number(texture(2, 2, 255), false), 2);
        let entries = textures.entries();
        assert_eq!(entries.len(), 3);
        let last = &entries[2];
        assert_eq!(last.at + last.length, textures.bytes.len());
    }

    #[test]
    fn colours_stay_where_alpha_is_zero() {
        let png = Fitted::of(&texture(2, 1, 0)).encoded().unwrap();
        let back = image::load_from_memory(&png).unwrap().into_rgba8();
        assert_eq!(back.as_raw()[..4], [10, 20, 30, 0]);
    }

    #[test]
    fn large_textures_are_halved() {
        let png = Fitted::of(&texture(5000, 3, 255)).encoded().unwrap();
        let back = image::load_from_memory(&png).unwrap();
        assert_eq!((back.width(), back.height()), (1250, 1));
        assert_eq!(back.into_rgb8().as_raw()[..3], [10, 20, 30]);
        let mut textures = Textures::of(Pictures::Texels);
        textures.number(&texture(5000, 3, 255), true).unwrap();
        let entry = &textures.entries()[0];
        assert_eq!(entry.texels, Some([1250, 1]));
        assert_eq!(entry.length, 4 * 1250);
    }
}
