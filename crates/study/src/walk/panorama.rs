//! The panorama: the far plants as a picture all around, that of the model itself, which L-plants draws behind what is
//! near.

use glam::DVec3;
use image::{Rgba, RgbaImage};
use rayon::prelude::*;
use secateur_eval::{LINEAR_FROM_SRGB, StandCamera, StandPicture, StandPlace, srgb_byte};

use super::scene::MIDDLE;

/// How many pictures it is made of.
const FACES: u32 = 8;

/// The tangent up to which it reaches above and below: what a frame of 60 degrees sees aside of a face's middle.
const TANGENT: f64 = 0.66;

/// Pictures all around from the middle of the path.
pub(super) struct Panorama {
    faces: Vec<RgbaImage>,
    /// What each of them would be if nothing stood there.
    plain: RgbaImage,
}

impl Panorama {
    /// The panorama of the plants at these places; each picture is `height_px` rows high.
    pub(super) fn of(places: &[StandPlace<'_>], height_px: u32) -> Self {
        let face = |k| StandPicture::of(places, &camera(k), height_px).image;
        Self {
            faces: (0..FACES).into_par_iter().map(face).collect(),
            plain: StandPicture::of(&[], &camera(0), height_px).image,
        }
    }

    /// What a camera shows of it, as if it were endlessly far off, before `plain`: what the camera sees where nothing
    /// stands.
    pub(super) fn seen_by(&self, camera: &StandCamera, plain: &RgbaImage) -> RgbaImage {
        let (width, height) = plain.dimensions();
        let right = camera.forward.cross(camera.up);
        let per_px = 2.0 * camera.tan_half_fov_y / f64::from(height);
        RgbaImage::from_fn(width, height, |x, y| {
            let aside = (f64::from(x) + 0.5 - 0.5 * f64::from(width)) * per_px;
            let up = (0.5 * f64::from(height) - f64::from(y) - 0.5) * per_px;
            let [shown, nothing] = self.towards(camera.forward + right * aside + camera.up * up);
            let own = plain.get_pixel(x, y);
            let light = |pixel: &Rgba<u8>, k: usize| LINEAR_FROM_SRGB[usize::from(pixel[k])];
            let mixed = |k| srgb_byte(light(own, k) + light(shown, k) - light(nothing, k));
            Rgba([mixed(0), mixed(1), mixed(2), 255])
        })
    }

    /// The pixel in a direction, and what it would be if nothing stood there.
    fn towards(&self, ray: DVec3) -> [&Rgba<u8>; 2] {
        let part = std::f64::consts::TAU / f64::from(FACES);
        let face = (ray.x.atan2(-ray.z) / part)
            .round()
            .rem_euclid(f64::from(FACES)) as u32;
        let seen = camera(face % FACES);
        let image = &self.faces[(face % FACES) as usize];
        let right = seen.forward.cross(seen.up);
        let ahead = ray.dot(seen.forward);
        let per_px = 2.0 * TANGENT / f64::from(image.height());
        let column = 0.5 * f64::from(image.width()) + ray.dot(right) / ahead / per_px;
        let row = 0.5 * f64::from(image.height()) - ray.y / ahead / per_px;
        let place = |at: f64, side: u32| (at.max(0.0) as u32).min(side - 1);
        let (x, y) = (place(column, image.width()), place(row, image.height()));
        [image, &self.plain].map(|image| image.get_pixel(x, y))
    }

    /// The half of it that lies before the path, from left to right.
    pub(super) fn picture(&self) -> RgbaImage {
        let parts: Vec<&RgbaImage> = [6, 7, 0, 1, 2].iter().map(|k| &self.faces[*k]).collect();
        let width = parts[0].width();
        let mut whole = RgbaImage::new(width * parts.len() as u32, parts[0].height());
        for (part, left) in parts.iter().zip((0..).step_by(width as usize)) {
            image::imageops::replace(&mut whole, *part, left, 0);
        }
        whole
    }
}

fn camera(face: u32) -> StandCamera {
    let part = std::f64::consts::TAU / f64::from(FACES);
    let (sin, cos) = (f64::from(face) * part).sin_cos();
    StandCamera {
        eye: MIDDLE,
        forward: DVec3::new(sin, 0.0, -cos),
        up: DVec3::Y,
        tan_half_fov_y: TANGENT,
        // A little over a part of the circle, so that edges have pixels on both sides.
        aspect: 1.02 * (0.5 * part).tan() / TANGENT,
        near: 0.1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ahead is the first face, to the right the third, behind the fifth.
    #[test]
    fn a_ray_meets_the_face_that_looks_its_way() {
        let face = |k: u32| RgbaImage::from_pixel(4, 4, Rgba([k as u8, 0, 0, 255]));
        let panorama = Panorama {
            faces: (0..FACES).map(face).collect(),
            plain: face(0),
        };
        let towards = |x, z| panorama.towards(DVec3::new(x, 0.1, z))[0].0[0];
        let found = [
            (0.0, -1.0),
            (1.0, -1.0),
            (1.0, 0.0),
            (0.0, 1.0),
            (-1.0, 0.0),
            (-0.1, -1.0),
        ];
        assert_eq!(found.map(|(x, z)| towards(x, z)), [0, 1, 2, 4, 6, 0]);
    }

    /// What a face shows is what a camera in its place shows, but for the last pixel.
    #[test]
    fn from_the_middle_it_is_what_stands_there() {
        let mut picture = RgbaImage::from_pixel(84, 132, Rgba([0; 4]));
        picture.put_pixel(60, 30, Rgba([255; 4]));
        let panorama = Panorama {
            faces: vec![picture; FACES as usize],
            plain: RgbaImage::new(84, 132),
        };
        let narrow = StandCamera {
            aspect: 0.4,
            ..super::camera(2)
        };
        let grey = RgbaImage::from_pixel(53, 132, Rgba([90, 90, 90, 255]));
        let seen = panorama.seen_by(&narrow, &grey);
        let lit = seen.enumerate_pixels().filter(|(_, _, p)| p.0[0] != 90);
        let lit: Vec<(u32, u32)> = lit.map(|(x, y, _)| (x, y)).collect();
        // 84 pixels wide there, 53 here: 18 pixels right of the middle are 44 or 45.
        assert_eq!(lit.len(), 1);
        assert!(
            lit[0].0.abs_diff(44) <= 1 && lit[0].1.abs_diff(30) <= 1,
            "{lit:?}"
        );
    }
}
