//! Writes labels on pictures: the captions of sheets and the names of their cells.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, iso_8859_1};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};
use image::{Rgba, RgbaImage};

/// A line of text in one of two sizes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<'a> {
    pub(crate) text: &'a str,
    pub(crate) ink: Rgba<u8>,
    /// Pixels for each dot of the letters.
    pub(crate) scale: u32,
}

const FONT: MonoFont<'static> = iso_8859_1::FONT_10X20;

/// The height of a line in pixels.
pub(crate) fn line_height(scale: u32) -> u32 {
    FONT.character_size.height * scale
}

/// The width of a line in pixels.
pub(crate) fn line_width(line: &Line<'_>) -> u32 {
    line.text.chars().count() as u32 * FONT.character_size.width * line.scale
}

/// Writes a line whose upper left corner is at `at`; what does not fit is cut off.
pub(crate) fn write_line(image: &mut RgbaImage, at: [u32; 2], line: &Line<'_>) {
    let mut page = Page { image, at, line };
    let style = MonoTextStyle::new(&FONT, BinaryColor::On);
    let text = Text::with_baseline(line.text, Point::zero(), style, Baseline::Top);
    let Ok(_) = text.draw(&mut page);
}

/// An image as a surface to write on, its dots enlarged.
struct Page<'a> {
    image: &'a mut RgbaImage,
    at: [u32; 2],
    line: &'a Line<'a>,
}

impl OriginDimensions for Page<'_> {
    fn size(&self) -> Size {
        Size::new(self.image.width(), self.image.height())
    }
}

impl DrawTarget for Page<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Infallible>
    where
        I: IntoIterator<Item = Pixel<BinaryColor>>,
    {
        let scale = self.line.scale;
        for Pixel(dot, color) in pixels {
            if color.is_off() || dot.x < 0 || dot.y < 0 {
                continue;
            }
            let left = self.at[0] + dot.x as u32 * scale;
            let top = self.at[1] + dot.y as u32 * scale;
            for y in top..top + scale {
                for x in left..left + scale {
                    if let Some(pixel) = self.image.get_pixel_mut_checked(x, y) {
                        *pixel = self.line.ink;
                    }
                }
            }
        }
        Ok(())
    }
}
