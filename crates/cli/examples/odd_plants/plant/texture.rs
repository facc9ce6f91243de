//! Pictures of leaves, ordinary and odd.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
use secateur_plant::Random;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Picture {
    None,
    /// A disc.
    Leaf,
    Clear,
    Solid,
    Noise,
    /// Every texel has this alpha.
    Even(u8),
    /// Only the first row is not clear.
    Edge,
    Grey,
    OneTexel,
    /// One row of texels.
    Row,
}

impl Picture {
    pub(crate) const ALL: [Self; 18] = [
        Self::Leaf,
        Self::Leaf,
        Self::Leaf,
        Self::Leaf,
        Self::Leaf,
        Self::Leaf,
        Self::Leaf,
        Self::None,
        Self::Clear,
        Self::Solid,
        Self::Noise,
        Self::Even(127),
        Self::Even(128),
        Self::Even(1),
        Self::Edge,
        Self::Grey,
        Self::OneTexel,
        Self::Row,
    ];

    /// The picture as a PNG, if there is one.
    pub(crate) fn png(self, random: &mut Random) -> Option<Vec<u8>> {
        let (width, height) = match self {
            Self::None => return None,
            Self::OneTexel => (1, 1),
            Self::Row => (64, 1),
            Self::Edge => (7, 5),
            _ => (16, 16),
        };
        let alpha = |x: u32, y: u32, random: &mut Random| match self {
            Self::None | Self::Leaf | Self::Grey | Self::Row => {
                let from_middle = |k: u32, of: u32| (f64::from(k) + 0.5) / f64::from(of) - 0.5;
                let distance = from_middle(x, width).hypot(from_middle(y, height));
                if distance < 0.45 { 255 } else { 0 }
            }
            Self::Clear => 0,
            Self::Solid | Self::OneTexel => 255,
            Self::Noise => random.bits() as u8,
            Self::Even(alpha) => alpha,
            Self::Edge => 255 * u8::from(y == 0),
        };
        let mut picture = RgbaImage::new(width, height);
        for (x, y, texel) in picture.enumerate_pixels_mut() {
            *texel = Rgba([40, 120, 30, alpha(x, y, random)]);
        }
        let picture = DynamicImage::from(picture);
        let picture = match self {
            Self::Grey => picture.into_luma_alpha8().into(),
            _ => picture,
        };
        let mut bytes = Cursor::new(Vec::new());
        picture
            .write_to(&mut bytes, ImageFormat::Png)
            .expect("a PNG");
        Some(bytes.into_inner())
    }
}
