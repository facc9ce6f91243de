//! Mip levels, averaged as graphics libraries do it for images of sRGB colours.

use image::RgbaImage;

/// An image and its mip levels, down to one texel.
pub(crate) fn mip_levels(image: &RgbaImage) -> Vec<RgbaImage> {
    let mut levels = vec![image.clone()];
    while let Some(last) = levels
        .last()
        .filter(|last| last.width().max(last.height()) > 1)
    {
        levels.push(half(last));
    }
    levels
}

/// The next mip level: each texel the mean of four, colours in linear light. Of an odd side the last row is left out.
fn half(image: &RgbaImage) -> RgbaImage {
    let [width, height] = [image.width(), image.height()];
    RgbaImage::from_fn((width / 2).max(1), (height / 2).max(1), |x, y| {
        let columns = [2 * x, (2 * x + 1).min(width - 1)];
        let rows = [2 * y, (2 * y + 1).min(height - 1)];
        let texels = rows.map(|row| columns.map(|column| image.get_pixel(column, row).0));
        let mean = |channel: usize, decoded: fn(u8) -> f32| {
            let values = texels
                .as_flattened()
                .iter()
                .map(|texel| decoded(texel[channel]));
            values.sum::<f32>() / 4.0
        };
        let [red, green, blue] = [0, 1, 2].map(|channel| srgb(mean(channel, linear)));
        let alpha = (mean(3, f32::from) + 0.5) as u8;
        image::Rgba([red, green, blue, alpha])
    })
}

/// Linear light of an sRGB value (IEC 61966-2-1).
fn linear(value: u8) -> f32 {
    let value = f32::from(value) / 255.0;
    match value <= 0.04045 {
        true => value / 12.92,
        false => ((value + 0.055) / 1.055).powf(2.4),
    }
}

/// The sRGB value of linear light.
fn srgb(light: f32) -> u8 {
    let value = match light <= 0.003_130_8 {
        true => light * 12.92,
        false => 1.055 * light.powf(1.0 / 2.4) - 0.055,
    };
    (value * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_halve_down_to_one_texel() {
        let sizes = |width, height| {
            let levels = mip_levels(&RgbaImage::new(width, height));
            levels
                .iter()
                .map(|level| level.dimensions())
                .collect::<Vec<_>>()
        };
        assert_eq!(sizes(8, 4), [(8, 4), (4, 2), (2, 1), (1, 1)]);
        assert_eq!(sizes(1, 1), [(1, 1)]);
    }

    #[test]
    fn black_and_white_average_in_linear_light() {
        let image = RgbaImage::from_fn(2, 2, |x, _| image::Rgba([x as u8 * 255; 4]));
        // Half of the light is 188 of 255 in sRGB; alpha is no light.
        assert_eq!(
            mip_levels(&image)[1].get_pixel(0, 0).0,
            [188, 188, 188, 128]
        );
        for value in 0..=255 {
            assert_eq!(srgb(linear(value)), value);
        }
    }
}
