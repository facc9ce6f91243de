//! Structural similarity of two pictures.
//!
//! Wang, Bovik, Sheikh, Simoncelli: Image Quality Assessment (IEEE TIP 13(4),
//! 2004), Eqs. 13 to 17: in a Gaussian window of 11 x 11 pixels and deviation
//! 1.5 about each pixel,
//!
//! ```text
//! SSIM = (2 m_x m_y + C1) (2 s_xy + C2) / ((m_x^2 + m_y^2 + C1) (s_x^2 + s_y^2 + C2))
//! ```
//!
//! with C1 = (0.01 x 255)^2, C2 = (0.03 x 255)^2, on luma. Written here because
//! the crates that compute it either divide variances by nothing or are under a
//! licence that this project cannot use.

use image::RgbaImage;

const RADIUS: usize = 5;
const DEVIATION_PX: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Mean SSIM over all pixels whose window lies in the picture; pictures smaller
/// than the window have one window, which is cut. -1 to 1, 1 for equal pictures.
///
/// # Panics
/// If the sizes differ or are zero.
pub(super) fn ssim(a: &RgbaImage, b: &RgbaImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions(), "pictures of one size");
    let (width, height) = (a.width() as usize, a.height() as usize);
    let (x, y) = (luma(a), luma(b));
    let product = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| p * q).collect();
    let mean = |plane: Vec<f64>| windowed(&plane, width, height);
    let (xx, yy, xy) = (
        mean(product(&x, &x)),
        mean(product(&y, &y)),
        mean(product(&x, &y)),
    );
    let (mx, my) = (mean(x), mean(y));
    let values = (0..mx.len()).map(|k| {
        let (mx, my) = (mx[k], my[k]);
        let (sx, sy, sxy) = (xx[k] - mx * mx, yy[k] - my * my, xy[k] - mx * my);
        (2.0 * mx * my + C1) * (2.0 * sxy + C2) / ((mx * mx + my * my + C1) * (sx + sy + C2))
    });
    values.sum::<f64>() / mx.len() as f64
}

/// Rec. 601 luma, 0 to 255.
fn luma(image: &RgbaImage) -> Vec<f64> {
    let of = |p: &image::Rgba<u8>| {
        let [r, g, b, _] = p.0.map(f64::from);
        0.299 * r + 0.587 * g + 0.114 * b
    };
    image.pixels().map(of).collect()
}

/// Weighted means in windows, of all windows that lie in the plane.
fn windowed(plane: &[f64], width: usize, height: usize) -> Vec<f64> {
    let across = filter(plane, width, height, width, 1);
    let columns = across.len() / height;
    filter(&across, height, columns, 1, columns)
}

/// Along one axis: `length` values a `step` apart in each of `lines` lines that
/// begin a `line_step` apart. The result has the same order of axes.
fn filter(plane: &[f64], length: usize, lines: usize, line_step: usize, step: usize) -> Vec<f64> {
    let weights = weights(length);
    let places = length + 1 - weights.len();
    let at = |line: usize, place: usize| {
        let start = line * line_step + place * step;
        let terms = weights.iter().enumerate();
        terms.map(|(k, w)| w * plane[start + k * step]).sum::<f64>()
    };
    if step == 1 {
        let lines = (0..lines).flat_map(|line| (0..places).map(move |place| (line, place)));
        lines.map(|(line, place)| at(line, place)).collect()
    } else {
        let rows = (0..places).flat_map(|place| (0..lines).map(move |line| (line, place)));
        rows.map(|(line, place)| at(line, place)).collect()
    }
}

/// Gaussian weights that sum to 1, as many as fit.
fn weights(length: usize) -> Vec<f64> {
    let count = length.min(2 * RADIUS + 1);
    let middle = 0.5 * (count as f64 - 1.0);
    let weight = |k: usize| (-0.5 * ((k as f64 - middle) / DEVIATION_PX).powi(2)).exp();
    let all: Vec<f64> = (0..count).map(weight).collect();
    let sum: f64 = all.iter().sum();
    all.iter().map(|w| w / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;

    fn grey(size: u32, value: impl Fn(u32, u32) -> u8) -> RgbaImage {
        RgbaImage::from_fn(size, size, |x, y| {
            let v = value(x, y);
            Rgba([v, v, v, 255])
        })
    }

    /// Flat pictures have no variance: the luminance term alone is left. For 100
    /// and 200: (2 x 20,000 + 6.5025) / (50,000 + 6.5025) = 0.800026.
    #[test]
    fn flat_pictures_differ_by_their_luminance() {
        let (a, b) = (grey(32, |_, _| 100), grey(32, |_, _| 200));
        assert!(
            (ssim(&a, &b) - 0.800_026_006).abs() < 1e-6,
            "{}",
            ssim(&a, &b)
        );
        assert!((ssim(&a, &a) - 1.0).abs() < 1e-12);
    }

    /// A chequerboard and its negative, 127.5 +- 50: means are nearly equal, the
    /// covariance is minus the variance of nearly 2,500, so SSIM is nearly
    /// (-5,000 + 58.5225) / (5,000 + 58.5225) = -0.97686.
    #[test]
    fn a_negative_is_the_opposite() {
        let board = |x: u32, y: u32| if (x + y).is_multiple_of(2) { 78 } else { 178 };
        let (a, b) = (grey(32, board), grey(32, |x, y| board(x + 1, y)));
        assert!((ssim(&a, &b) + 0.976_86).abs() < 1e-3, "{}", ssim(&a, &b));
    }

    #[test]
    fn small_and_long_pictures_have_windows_too() {
        let a = RgbaImage::from_pixel(3, 20, Rgba([10, 20, 30, 255]));
        assert!((ssim(&a, &a) - 1.0).abs() < 1e-12);
        assert_eq!(windowed(&[1.0; 60], 3, 20).len(), 10);
    }
}
