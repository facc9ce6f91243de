//! From distances to heights on a screen.

use std::ops::RangeInclusive;

/// The screen that levels are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Screen {
    /// The height of the screen that the levels are for, in pixels.
    #[cfg_attr(feature = "cli", arg(long = "screen-height", value_name = "PX"))]
    #[cfg_attr(feature = "cli", arg(default_value_t = 1080.0, value_parser = height))]
    pub height_px: f64,
    /// The vertical field of view of the camera that they are seen by, in degrees.
    #[cfg_attr(feature = "cli", arg(long = "fov", value_name = "DEGREES"))]
    #[cfg_attr(feature = "cli", arg(default_value_t = 60.0, value_parser = field_of_view))]
    pub field_of_view_degrees: f64,
}

/// The heights that a screen may have, in pixels.
pub const SCREEN_HEIGHTS_PX: RangeInclusive<f64> = 16.0..=1e5;

#[cfg(feature = "cli")]
fn height(text: &str) -> Result<f64, String> {
    let px = text
        .parse()
        .ok()
        .filter(|px| SCREEN_HEIGHTS_PX.contains(px));
    px.ok_or_else(|| "write a number of pixels from 16 to 100000".to_owned())
}

#[cfg(feature = "cli")]
fn field_of_view(text: &str) -> Result<f64, String> {
    let degrees = text.parse().ok().filter(|n| (1.0..179.0).contains(n));
    degrees.ok_or_else(|| "write a number of degrees from 1 to 179".to_owned())
}

impl Default for Screen {
    /// 1080 pixels and 60 degrees.
    fn default() -> Self {
        Self {
            height_px: 1080.0,
            field_of_view_degrees: 60.0,
        }
    }
}

impl Screen {
    /// How many pixels high it shows a plant of this height at this distance:
    /// `height_px * plant_height / (2 distance tan(fov / 2))`.
    pub fn pixels_high(&self, plant_height: f64, distance: f64) -> f64 {
        self.height_px * plant_height / (2.0 * distance * self.half_tangent())
    }

    /// The distance at which a plant of this height is shown at this height in pixels; 0 for a plant that lies
    /// flat.
    pub fn distance(&self, plant_height: f64, pixels_high: f64) -> f64 {
        if plant_height == 0.0 {
            return 0.0;
        }
        self.height_px * plant_height / (2.0 * pixels_high * self.half_tangent())
    }

    fn half_tangent(&self) -> f64 {
        (self.field_of_view_degrees.to_radians() / 2.0).tan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plant_as_high_as_the_view_fills_the_screen() {
        // 90 degrees see 2 m at a distance of 1 m.
        let screen = Screen {
            height_px: 1000.0,
            field_of_view_degrees: 90.0,
        };
        assert!((screen.pixels_high(2.0, 1.0) - 1000.0).abs() < 1e-9);
        assert!((screen.pixels_high(2.0, 4.0) - 250.0).abs() < 1e-9);
        assert!((screen.distance(2.0, 250.0) - 4.0).abs() < 1e-9);
        assert_eq!(screen.distance(0.0, screen.pixels_high(0.0, 4.0)), 0.0);
    }
}
