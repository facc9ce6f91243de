//! Images: decoding them, within limits.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;

use image::{ImageReader, Limits, RgbaImage};

use super::Document;
use super::error::{At, Fault, Problem, shortened};
use super::folder;
use super::ktx2;
use super::property;
use super::uri::{self, Target};
use secateur_model::{Budget, Filters, Remedy, Texture, Wrap};

/// The most texels of one image.
const MAX_TEXELS: u64 = 64 << 20;

/// The most texels that are decoded of one file, all images together.
const MAX_TEXELS_TOGETHER: u64 = 256 << 20;

/// The most bytes of an image file beside the glTF.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// What a texel takes: its pixels, as they come out of the decoder, and as a
/// renderer has them.
const BYTES_A_TEXEL: u64 = 12;

/// The command that makes all images of a file PNG, AVIF among them.
const TO_PNG: &str = "convert it with `npx @gltf-transform/cli png IN.glb OUT.glb`";

/// What to do where images take too much memory.
const SMALLER: Remedy = Remedy::SmallerImages;

/// The images of a document, each decoded at most once.
pub(crate) struct Pictures<'a> {
    document: &'a Document,
    decoded: Vec<Option<Decoded>>,
    /// The first entry of `images` that was decoded from each source.
    first_of: HashMap<ImageBytes, usize>,
    textures: HashMap<(usize, [Wrap; 2], Filters), Arc<Texture>>,
    texels: u64,
    /// What is left for images, and for what is made of them.
    pub(crate) budget: Budget,
}

/// Where the bytes of an image are; entries of `images` may share them.
#[derive(Clone, PartialEq, Eq, Hash)]
enum ImageBytes {
    View(usize),
    /// A file, links followed.
    File(PathBuf),
}

/// An image, or why it can't be had.
#[derive(Clone)]
pub(crate) enum Decoded {
    /// The pixels of an image that could be decoded.
    Picture(Arc<Picture>),
    /// The image can't be decoded: it then counts as opaque white.
    Unusable(Arc<str>),
}

/// The pixels of an image, and what was counted over them.
pub(crate) struct Picture {
    /// sRGB colour and alpha.
    pub(crate) image: RgbaImage,
    pub(crate) tally: Tally,
}

/// Texels counted and colours added up by alpha, so that materials that share
/// an image need not each go over it.
pub(crate) struct Tally {
    /// Texels, red, green and blue.
    sums: [[u64; 4]; 256],
}

impl Tally {
    fn of(image: &RgbaImage) -> Self {
        let mut sums = [[0; 4]; 256];
        for &[red, green, blue, alpha] in image.as_raw().as_chunks().0 {
            let sum = &mut sums[usize::from(alpha)];
            for (sum, value) in sum.iter_mut().zip([1, red, green, blue]) {
                *sum += u64::from(value);
            }
        }
        Self { sums }
    }

    /// How many texels have this alpha.
    pub(crate) fn texels(&self, alpha: u8) -> u64 {
        self.sums[usize::from(alpha)][0]
    }

    /// The sums of red, green and blue of the texels of this alpha.
    pub(crate) fn color(&self, alpha: u8) -> [u64; 3] {
        let [_, red, green, blue] = self.sums[usize::from(alpha)];
        [red, green, blue]
    }
}

impl<'a> Pictures<'a> {
    /// The images of this document; none is decoded before it is asked for.
    pub(crate) fn new(document: &'a Document, budget: Budget) -> Self {
        Self {
            document,
            decoded: Vec::new(),
            first_of: HashMap::new(),
            textures: HashMap::new(),
            texels: 0,
            budget,
        }
    }

    /// The pixels of `images[index]`, or why there are none. They stay where [`Document::keep_images`] asks for it.
    pub(crate) fn get(&mut self, index: usize) -> Result<Decoded, Fault> {
        let decoded = self.decoded_once(index)?;
        self.document.kept_images.keep_image(index, &decoded);
        Ok(decoded)
    }

    /// As [`Self::get`], of an image that is needed once.
    pub(crate) fn decoded_once(&mut self, index: usize) -> Result<Decoded, Fault> {
        if self.decoded.len() <= index {
            self.decoded.resize(index + 1, None);
        }
        if let Some(known) = &self.decoded[index] {
            return Ok(known.clone());
        }
        if let Some(kept) = self.document.kept_images.image(index) {
            self.decoded[index] = Some(kept.clone());
            return Ok(kept);
        }
        if let Some(source) = self.document.image_source(index) {
            let first = *self.first_of.entry(source).or_insert(index);
            if let Some(known) = &self.decoded[first] {
                let known = known.clone();
                self.decoded[index] = Some(known.clone());
                return Ok(known);
            }
        }
        let most_texels = MAX_TEXELS.min(MAX_TEXELS_TOGETHER - self.texels);
        let place = || self.document.place("images", index);
        let decoded = match self.document.image_bytes(index, &mut self.budget)? {
            Err(why) => Err(why),
            Ok(bytes) => match dimensions(&bytes, most_texels) {
                Err(why) => Err(why),
                Ok([width, height]) => {
                    let texels = u64::from(width) * u64::from(height);
                    let what = || format!("its {width} x {height} texels");
                    let taken = self.budget.take(BYTES_A_TEXEL * texels, what, SMALLER);
                    taken.map_err(Problem::from).at(place)?;
                    // Added before decoding: images that fail take time too.
                    self.texels += texels;
                    decode(&bytes)
                }
            },
        };
        let decoded = match decoded {
            Ok(image) => {
                let tally = Tally::of(&image);
                Decoded::Picture(Arc::new(Picture { image, tally }))
            }
            Err(why) => Decoded::Unusable(why.into()),
        };
        self.decoded[index] = Some(decoded.clone());
        Ok(decoded)
    }

    /// `images[index]` as renderers want it; all that wrap and filter it alike share its pixels.
    /// `None` if it can't be decoded.
    pub(crate) fn texture(
        &mut self,
        index: usize,
        wrap: [Wrap; 2],
        filters: Filters,
    ) -> Result<Option<Arc<Texture>>, Fault> {
        let Decoded::Picture(picture) = self.get(index)? else {
            return Ok(None);
        };
        let source = self.document.image_source(index);
        let first = source.and_then(|source| self.first_of.get(&source));
        let key = (first.copied().unwrap_or(index), wrap, filters);
        let kept = &self.document.kept_images;
        let texture = self.textures.entry(key).or_insert_with(|| {
            kept.texture(key, || {
                Arc::new(Texture {
                    width: picture.image.width(),
                    height: picture.image.height(),
                    rgba: picture.image.as_raw().clone(),
                    wrap,
                    filters,
                })
            })
        });
        Ok(Some(Arc::clone(texture)))
    }

    /// One sentence for each image that was asked for and can't be decoded.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let sentence = |(index, decoded): (usize, &Option<Decoded>)| match decoded {
            Some(Decoded::Unusable(why)) => Some(format!(
                "{}: {why}; it is taken for opaque",
                self.document.place("images", index)
            )),
            _ => None,
        };
        self.decoded
            .iter()
            .enumerate()
            .filter_map(sentence)
            .collect()
    }
}

fn reader(bytes: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, String> {
    ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| error.to_string())
}

fn undecodable(error: image::ImageError) -> String {
    format!("it cannot be decoded ({error})")
}

/// Width and height of an image, which its header says.
fn dimensions(bytes: &[u8], most_texels: u64) -> Result<[u32; 2], String> {
    let (width, height) = if ktx2::is_ktx2(bytes) {
        ktx2::dimensions(bytes)?.into()
    } else {
        let reader = reader(bytes)?;
        if reader
            .format()
            .is_none_or(|format| !format.reading_enabled())
        {
            return Err(format!(
                "its format is not PNG, JPEG, WebP or KTX2; {TO_PNG}"
            ));
        }
        reader.into_dimensions().map_err(undecodable)?
    };
    let texels = u64::from(width) * u64::from(height);
    if texels > most_texels {
        return Err(format!(
            "its {width} x {height} texels are more than the {most_texels} allowed"
        ));
    }
    Ok([width, height])
}

fn decode(bytes: &[u8]) -> Result<RgbaImage, String> {
    let picture = if ktx2::is_ktx2(bytes) {
        ktx2::decode(bytes)?
    } else {
        let mut limits = Limits::default();
        limits.max_alloc = Some(MAX_TEXELS * 8);
        let mut reader = reader(bytes)?;
        reader.limits(limits);
        reader.decode().map_err(undecodable)?.into_rgba8()
    };
    if picture.width() == 0 || picture.height() == 0 {
        return Err("it has no texel".to_owned());
    }
    Ok(picture)
}

impl Document {
    /// Where the bytes of an image are, if others may name the same place.
    fn image_source(&self, index: usize) -> Option<ImageBytes> {
        let json = self.root.get("images")?.get(index)?;
        if let Some(view) = json.get("bufferView") {
            return Some(ImageBytes::View(usize::try_from(view.as_u64()?).ok()?));
        }
        let uri = json.get("uri")?.as_str()?;
        let relative = uri::file(uri)?;
        let file = folder::find(self.base_dir.as_deref(), &relative, uri);
        file.ok().map(ImageBytes::File)
    }

    /// Width and height of an image, if it is one that can be decoded.
    pub(crate) fn image_size(&self, index: usize) -> Option<[u32; 2]> {
        let mut budget = self.budget;
        let bytes = self.image_bytes(index, &mut budget).ok()?.ok()?;
        dimensions(&bytes, MAX_TEXELS).ok()
    }

    /// The encoded bytes of an image, if they can be had.
    pub(crate) fn encoded_image(&self, index: usize) -> Option<Vec<u8>> {
        let mut budget = self.budget;
        let bytes = self.image_bytes(index, &mut budget).ok()?.ok()?;
        Some(bytes.into_owned())
    }

    /// The encoded bytes of an image; the inner error says why it can't be had
    /// though the file is sound.
    fn image_bytes(
        &self,
        index: usize,
        budget: &mut Budget,
    ) -> Result<Result<Cow<'_, [u8]>, String>, Fault> {
        let json = property::entry(&self.root, "images", index)?;
        let place = || self.place("images", index);
        if let Some(view) = property::index(json, "bufferView").at(place)? {
            property::entry(&self.root, "bufferViews", view).at(place)?;
            return Ok(Ok(self.view_bytes(view)?));
        }
        let uri = property::text(json, "uri")
            .and_then(|uri| uri.ok_or(Problem::Missing("uri")))
            .at(place)?;
        match uri::resolve(uri).at(place)? {
            Target::Data(bytes) => Ok(Ok(Cow::Owned(bytes))),
            Target::File { relative, uri } => {
                let mut read = || {
                    let file = folder::find(self.base_dir.as_deref(), &relative, uri)?;
                    let there = std::fs::metadata(&file).map_or(0, |there| there.len());
                    let what = || format!("the file `{}`", shortened(uri));
                    budget.take(there.min(MAX_FILE_BYTES), what, SMALLER)?;
                    folder::read_file(&file, uri, MAX_FILE_BYTES)
                };
                match read() {
                    Ok(bytes) => Ok(Ok(Cow::Owned(bytes))),
                    Err(Problem::MissingFile { uri, error }) => Ok(Err(format!(
                        "the file `{}` cannot be read ({error})",
                        shortened(&uri)
                    ))),
                    Err(other) => Err(other).at(place),
                }
            }
        }
    }
}
