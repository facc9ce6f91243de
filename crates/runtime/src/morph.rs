//! How a level becomes the next one while the camera goes away: the twin of `shaders/morph.wgsl`.

use glam::Vec3;

/// How far on its way a plant is at a distance, 0 to 1: a level's `blend_begin` and `blend_end`, all in metres.
pub fn morph_share(distance_m: f32, begin_m: f32, end_m: f32) -> f32 {
    ((distance_m - begin_m) / (end_m - begin_m)).clamp(0.0, 1.0)
}

/// Where a vertex is that goes to `next`, its `_MORPH`. A device may round otherwise, by some units in the last place.
pub fn morphed(position: Vec3, next: Vec3, share: f32) -> Vec3 {
    position * (1.0 - share) + next * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_is_at_both_ends_where_its_levels_have_it() {
        let [from, to] = [Vec3::new(0.1, -3.0, 7.7), Vec3::new(0.3, 2.0, -0.7)];
        let at = |metres| morphed(from, to, morph_share(metres, 20.0, 22.0));
        assert_eq!([0.0, 20.0].map(at), [from; 2]);
        assert_eq!([22.0, 99.0].map(at), [to; 2]);
        assert_eq!(at(21.0).y, -0.5);
    }

    /// Godot's language has no parser here, but these functions are GLSL; browsers compile that in the preview page.
    #[test]
    fn all_shaders_have_the_same_functions() {
        use secateur_shaders::{MORPH, MORPH_GLSL, MORPH_GODOT};
        let code = |source: &str| -> Vec<String> {
            let lines = source.lines().map(str::trim);
            let code = lines.filter(|line| !line.starts_with("//") && !line.is_empty());
            code.map(str::to_owned).collect()
        };
        assert_eq!(code(MORPH_GODOT), code(MORPH_GLSL));
        let returned = |source: &str| -> Vec<String> {
            let all = code(source).into_iter();
            all.filter(|line| line.starts_with("return")).collect()
        };
        assert_eq!(returned(MORPH), returned(MORPH_GLSL));
        assert_eq!(returned(MORPH).len(), 2);
    }
}
