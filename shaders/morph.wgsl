// How a level becomes the next one: functions for a vertex shader. The twin is `secateur_runtime::morph`.

// How far on its way a plant is at this distance, 0 to 1: `begin_m` and `end_m` are `blend_begin` and
// `blend_end` of its level.
fn morph_share(distance_m: f32, begin_m: f32, end_m: f32) -> f32 {
    return clamp((distance_m - begin_m) / (end_m - begin_m), 0.0, 1.0);
}

// Where a vertex is: `next` is its _MORPH.
fn morphed(position: vec3<f32>, next: vec3<f32>, share: f32) -> vec3<f32> {
    return mix(position, next, share);
}
