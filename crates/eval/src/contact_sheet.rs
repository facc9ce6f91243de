//! Pictures side by side, with captions.

use image::{Rgba, RgbaImage, imageops};

use crate::caption::{Line, line_height, line_width, write_line};

/// A picture of a contact sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What it shows, in large letters: "50 %".
    pub title: String,
    /// What there is to say about it, a line each: "1,500 leaves".
    pub subtitle: String,
    /// The picture, drawn above its title and subtitle.
    pub image: RgbaImage,
}

const PAPER: Rgba<u8> = Rgba([250, 250, 248, 255]);
const INK: Rgba<u8> = Rgba([38, 42, 40, 255]);
const PALE_INK: Rgba<u8> = Rgba([96, 102, 98, 255]);
const GAP_PX: u32 = 16;
const TITLE_SCALE: u32 = 2;
const SUBTITLE_SCALE: u32 = 1;

/// Panels from left to right, each with its title and subtitle below it, centred.
///
/// Every panel has the width of the widest picture; pictures stand on a common
/// ground line. Letters beyond Latin-1 become question marks, and lines wider
/// than their panel are cut off. No panel: an empty sheet of one pixel.
pub fn contact_sheet(panels: &[Panel]) -> RgbaImage {
    let widest = |size: fn(&Panel) -> u32| panels.iter().map(size).max().unwrap_or(0);
    let panel_width = widest(|panel| panel.image.width());
    let image_height = widest(|panel| panel.image.height());
    let lines = widest(|panel| panel.subtitle.lines().count() as u32);
    let captions_height = line_height(TITLE_SCALE) + lines * line_height(SUBTITLE_SCALE);
    let count = panels.len() as u32;
    if count == 0 {
        return RgbaImage::from_pixel(1, 1, PAPER);
    }
    let width = count * (panel_width + GAP_PX) + GAP_PX;
    let height = image_height + captions_height + 3 * GAP_PX;
    let mut sheet = RgbaImage::from_pixel(width, height, PAPER);
    for (index, panel) in panels.iter().enumerate() {
        let left = GAP_PX + index as u32 * (panel_width + GAP_PX);
        let x = left + (panel_width - panel.image.width()) / 2;
        let y = GAP_PX + image_height - panel.image.height();
        imageops::replace(&mut sheet, &panel.image, x.into(), y.into());
        write_captions(
            &mut sheet,
            panel,
            [left, 2 * GAP_PX + image_height],
            panel_width,
        );
    }
    sheet
}

fn write_captions(sheet: &mut RgbaImage, panel: &Panel, at: [u32; 2], panel_width: u32) {
    let title = Line {
        text: &panel.title,
        ink: INK,
        scale: TITLE_SCALE,
    };
    let subtitles = panel.subtitle.lines().map(|text| Line {
        text,
        ink: PALE_INK,
        scale: SUBTITLE_SCALE,
    });
    let mut y = at[1];
    for line in std::iter::once(title).chain(subtitles) {
        let mut strip = RgbaImage::from_pixel(panel_width, line_height(line.scale), PAPER);
        let x = panel_width.saturating_sub(line_width(&line)) / 2;
        write_line(&mut strip, [x, 0], &line);
        imageops::replace(sheet, &strip, at[0].into(), y.into());
        y += line_height(line.scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(width: u32, height: u32, title: &str, shade: u8) -> Panel {
        Panel {
            title: title.into(),
            subtitle: "12 leaves\n24 triangles".into(),
            image: RgbaImage::from_pixel(width, height, Rgba([shade, 0, 0, 255])),
        }
    }

    #[test]
    fn panels_stand_side_by_side_on_one_ground_line() {
        let sheet = contact_sheet(&[panel(100, 60, "a", 1), panel(80, 40, "b", 2)]);
        // Two panels of 100 and three gaps of 16; 60 of picture, 40 + 2 * 20 of
        // caption and three gaps.
        assert_eq!(sheet.dimensions(), (248, 188));
        assert_eq!(sheet.get_pixel(16, 16)[0], 1);
        assert_eq!(sheet.get_pixel(115, 75)[0], 1);
        // The second: 132 + (100 - 80) / 2 = 142, down to the same row 75.
        assert_eq!(sheet.get_pixel(142, 36)[0], 2);
        assert_eq!(sheet.get_pixel(221, 75)[0], 2);
        assert_eq!(*sheet.get_pixel(142, 35), PAPER);
        assert_eq!(*sheet.get_pixel(142, 76), PAPER);
    }

    #[test]
    fn captions_are_written_and_stay_under_their_panel() {
        let ink_in = |sheet: &RgbaImage, columns: std::ops::Range<u32>| {
            let inked =
                |(x, y, p): (u32, u32, &Rgba<u8>)| y > 80 && columns.contains(&x) && *p == INK;
            sheet.enumerate_pixels().filter(|&all| inked(all)).count()
        };
        let long = "a title far too long for its panel";
        let sheet = contact_sheet(&[panel(100, 60, "", 1), panel(100, 60, long, 2)]);
        assert_eq!(ink_in(&sheet, 0..132), 0);
        assert!(ink_in(&sheet, 132..232) > 100);
        assert_eq!(ink_in(&sheet, 232..248), 0);
    }

    #[test]
    fn no_panel_is_an_empty_sheet() {
        assert_eq!(contact_sheet(&[]).dimensions(), (1, 1));
    }
}
