//! One camera: where it stands, where it looks, and how it projects points to pixels.

use glam::{DQuat, DVec3};

use crate::snap::AFFINE_DEPTH_RATIO;

/// Why a camera cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// A number is NaN or infinite.
    #[error("a camera has a coordinate that is not a finite number")]
    NotFinite,
    /// Eye and target coincide, or the up vector points along the view.
    #[error("a camera's eye, target and up vector do not span a view")]
    NoDirection,
    /// The field of view is not between 0 and 180 degrees, both excluded.
    #[error("a camera's field of view of {0} degrees is not between 0 and 180")]
    FieldOfView(f64),
    /// The near distance is not positive.
    #[error("a camera's near distance {0} is not a positive number")]
    Near(f64),
}

/// A perspective camera with a square image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub(crate) eye: DVec3,
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) tan_half_fov: f64,
    pub(crate) near: f64,
    pub(crate) affine_depth_ratio: f64,
    /// Leaves whose texels are at most this far out of place on the image are not cut, however deep
    /// they are.
    pub(crate) affine_error_px: f64,
}

impl View {
    /// The tangent of half of 60 degrees, the field of view of every built-in
    /// view set, to the last bit on every platform.
    pub const TAN_30_DEGREES: f64 = 0.577_350_269_189_625_8;

    /// A camera at `eye` looking at `target`, both in world space.
    ///
    /// `up_hint` is any vector that is not along the view; `tan_half_fov` the
    /// tangent of half the field of view (the same across and down); nothing
    /// nearer than `near` (world units along the view) is seen.
    ///
    /// # Errors
    /// [`ViewError`] if the numbers make no camera.
    pub fn look_at(
        eye: DVec3,
        target: DVec3,
        up_hint: DVec3,
        tan_half_fov: f64,
        near: f64,
    ) -> Result<Self, ViewError> {
        if ![eye, target, up_hint].iter().all(|p| p.is_finite()) {
            return Err(ViewError::NotFinite);
        }
        if !(tan_half_fov.is_finite() && tan_half_fov > 0.0) {
            return Err(ViewError::FieldOfView(
                2.0 * tan_half_fov.atan().to_degrees(),
            ));
        }
        if !(near.is_finite() && near > 0.0) {
            return Err(ViewError::Near(near));
        }
        let unit = |v: DVec3| {
            // Scaled first so that tiny and huge scenes neither under- nor overflow.
            let scaled = v / v.abs().max_element();
            let unit = scaled / scaled.length();
            unit.is_finite().then_some(unit)
        };
        let forward = unit(target - eye).ok_or(ViewError::NoDirection)?;
        let up_hint = unit(up_hint).ok_or(ViewError::NoDirection)?;
        let side = forward.cross(up_hint);
        if side.length() < 1e-9 {
            return Err(ViewError::NoDirection);
        }
        let right = unit(side).ok_or(ViewError::NoDirection)?;
        let up = right.cross(forward);
        Ok(Self {
            eye,
            right,
            up,
            forward,
            tan_half_fov,
            near,
            affine_depth_ratio: AFFINE_DEPTH_RATIO,
            affine_error_px: 0.0,
        })
    }

    /// This camera, with textures 16 times as exact: not a 64th of a leaf but a 1024th of it, or
    /// a 64th of a pixel where that is more, out of place ([`AFFINE_DEPTH_RATIO`]), but for leaves as
    /// deep as they are far. It takes up to several times as long to draw leaves that have a cut-out.
    #[must_use]
    pub fn with_exact_textures(self) -> Self {
        Self {
            affine_depth_ratio: AFFINE_DEPTH_RATIO / 16.0,
            affine_error_px: 1.0 / 64.0,
            ..self
        }
    }

    /// This camera turned about a point by a turn of length 1.
    pub(crate) fn turned(self, about: DVec3, turn: DQuat) -> Self {
        Self {
            eye: about + turn * (self.eye - about),
            right: turn * self.right,
            up: turn * self.up,
            forward: turn * self.forward,
            ..self
        }
    }

    /// World-space position of the camera.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Unit vector of the view direction in world space.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Unit vector up the image in world space.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The tangent of half the field of view, the same across and down.
    pub fn tan_half_fov(&self) -> f64 {
        self.tan_half_fov
    }

    /// Nothing nearer than this is seen, in world units along the view.
    pub fn near(&self) -> f64 {
        self.near
    }

    /// A world-space point in camera space: right, up, forward.
    #[inline]
    pub(crate) fn camera_from_world(&self, point: DVec3) -> DVec3 {
        let p = point - self.eye;
        DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.forward))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_up_forward() {
        let view = View::look_at(DVec3::Z * 2.0, DVec3::ZERO, DVec3::Y, 1.0, 0.1).unwrap();
        // Looking down -z with y up, +x is to the right.
        assert_eq!(
            view.camera_from_world(DVec3::new(0.25, 0.5, 0.0)),
            DVec3::new(0.25, 0.5, 2.0)
        );
    }

    #[test]
    fn what_is_no_camera_is_refused() {
        let look = |eye, target, up, tan, near| View::look_at(eye, target, up, tan, near);
        let [o, x, y] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(look(o, o, y, 1.0, 0.1), Err(ViewError::NoDirection));
        assert_eq!(look(o, y, y, 1.0, 0.1), Err(ViewError::NoDirection));
        assert_eq!(look(o, x, y, 1.0, 0.0), Err(ViewError::Near(0.0)));
        assert_eq!(
            look(o, x * f64::NAN, y, 1.0, 0.1),
            Err(ViewError::NotFinite)
        );
        assert!(matches!(
            look(o, x, y, -1.0, 0.1),
            Err(ViewError::FieldOfView(_))
        ));
    }

    #[test]
    fn the_field_of_view_is_sixty_degrees() {
        assert_eq!(View::TAN_30_DEGREES, 1.0 / 3.0f64.sqrt());
    }
}
