//! Images: decoding them, within limits.

use std::borrow::Cow;
use std::io::Cursor;
use std::sync::Arc;

use image::{ImageReader, Limits, RgbaImage};

use super::Document;
use super::error::{At, Fault, Problem, shortened};
use super::folder;
use super::property;
use super::uri::{self, Target};

/// The most texels of one image.
const MAX_TEXELS: u64 = 64 << 20;

/// The most texels that are decoded of one file, all images together.
const MAX_TEXELS_TOGETHER: u64 = 256 << 20;

/// The most bytes of an image file beside the glTF.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// The images of a document, each decoded at most once.
pub(crate) struct Pictures<'a> {
    document: &'a Document,
    decoded: Vec<Option<Decoded>>,
    texels: u64,
}

/// An image, or why it can't be had.
#[derive(Clone)]
pub(crate) enum Decoded {
    /// The pixels of an image that could be decoded.
    Picture(Arc<Picture>),
    /// It can't be decoded: it then counts as opaque white.
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
        for pixel in image.pixels() {
            let [red, green, blue, alpha] = pixel.0;
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
    pub(crate) fn new(document: &'a Document) -> Self {
        Self {
            document,
            decoded: Vec::new(),
            texels: 0,
        }
    }

    /// The pixels of `images[index]`, or why there are none.
    pub(crate) fn get(&mut self, index: usize) -> Result<Decoded, Fault> {
        if self.decoded.len() <= index {
            self.decoded.resize(index + 1, None);
        }
        if let Some(known) = &self.decoded[index] {
            return Ok(known.clone());
        }
        let budget = MAX_TEXELS.min(MAX_TEXELS_TOGETHER - self.texels);
        let decoded = match self.document.image_bytes(index)? {
            Err(why) => Err(why),
            Ok(bytes) => decode(&bytes, budget, &mut self.texels),
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

/// `texels` is added to before decoding: images that fail take time too.
fn decode(bytes: &[u8], most_texels: u64, all_texels: &mut u64) -> Result<RgbaImage, String> {
    let reader = || {
        ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| error.to_string())
    };
    if reader()?.format().is_none() {
        return Err("its format is not PNG, JPEG or WebP".to_owned());
    }
    let undecodable = |error: image::ImageError| format!("it cannot be decoded ({error})");
    let (width, height) = reader()?.into_dimensions().map_err(undecodable)?;
    let texels = u64::from(width) * u64::from(height);
    if texels > most_texels {
        return Err(format!(
            "its {width} x {height} texels are more than the {most_texels} allowed"
        ));
    }
    *all_texels += texels;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_TEXELS * 8);
    let mut reader = reader()?;
    reader.limits(limits);
    let picture = reader.decode().map_err(undecodable)?.into_rgba8();
    if picture.width() == 0 || picture.height() == 0 {
        return Err("it has no texel".to_owned());
    }
    Ok(picture)
}

impl Document {
    /// The encoded bytes of an image; the inner error says why it can't be had
    /// though the file is sound.
    fn image_bytes(&self, index: usize) -> Result<Result<Cow<'_, [u8]>, String>, Fault> {
        let json = property::entry(&self.root, "images", index)?;
        let place = || self.place("images", index);
        if let Some(view) = property::index(json, "bufferView").at(place)? {
            property::entry(&self.root, "bufferViews", view).at(place)?;
            return Ok(Ok(Cow::Borrowed(self.view_bytes(view)?)));
        }
        let uri = property::text(json, "uri")
            .and_then(|uri| uri.ok_or(Problem::Missing("uri")))
            .at(place)?;
        match uri::resolve(uri).at(place)? {
            Target::Data(bytes) => Ok(Ok(Cow::Owned(bytes))),
            Target::File { relative, uri } => {
                let base_dir = self.base_dir.as_deref();
                match folder::read(base_dir, &relative, uri, MAX_FILE_BYTES) {
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
