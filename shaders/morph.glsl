// morph.wgsl for WebGL 2 and OpenGL (GLSL ES 3.00): paste it into a vertex shader.

// How far on its way to the next level a plant is at this distance, 0 to 1: begin_m and end_m are
// blend_begin and blend_end of its level.
float morph_share(float distance_m, float begin_m, float end_m) {
  return clamp((distance_m - begin_m) / (end_m - begin_m), 0.0, 1.0);
}

// Where a vertex is: next is its _MORPH.
vec3 morphed(vec3 position, vec3 next, float share) {
  return mix(position, next, share);
}
