#version 300 es
// Unpacks a vertex; see geometry.rs for how it was packed.
layout(location = 0) in vec3 a_steps;
layout(location = 1) in vec2 a_octahedral;
layout(location = 2) in vec2 a_uv;
layout(location = 3) in vec4 a_color;
layout(location = 4) in uint a_leaf;
// What it hangs on.
layout(location = 5) in vec3 a_pivot;
layout(location = 6) in float a_along;
layout(location = 7) in uint a_segment;
// Where it is when the next level takes over.
layout(location = 8) in vec3 a_end;

uniform mat4 u_clip_from_world;
uniform vec3 u_origin;
uniform vec3 u_step;
// Whether leaves have the sizes of a level of a removal order, and its steps.
uniform bool u_has_sizes;
uniform uint u_steps;
// Whether the wind blows, and vertices say what they hang on.
uniform bool u_sways;
// How far it is on the way there, 0 to 1.
uniform float u_share;
// Two texels a leaf: where its sizes begin and end, its centre.
uniform highp usampler2D u_leaves;
// From which step on, and the bits of the linear scale.
uniform highp usampler2D u_sizes;

out vec3 v_world;
out vec3 v_normal;
out vec2 v_uv;
out vec4 v_color;

vec3 unfolded(vec2 square) {
  vec3 normal = vec3(square, 1.0 - abs(square.x) - abs(square.y));
  float below = max(-normal.z, 0.0);
  normal.x += normal.x >= 0.0 ? -below : below;
  normal.y += normal.y >= 0.0 ? -below : below;
  return normalize(normal);
}

ivec2 texel(uint index) {
  return ivec2(index & 2047u, index >> 11u);
}

// The last size that a step up to the level's gave it; 0 where it is not made yet.
float scale_of(uint leaf) {
  uvec2 range = texelFetch(u_leaves, texel(2u * leaf), 0).xy;
  uint low = range.x;
  uint high = range.y;
  while (low < high) {
    uint middle = low + (high - low) / 2u;
    if (texelFetch(u_sizes, texel(middle), 0).x <= u_steps) low = middle + 1u;
    else high = middle;
  }
  if (low == range.x) return 0.0;
  return uintBitsToFloat(texelFetch(u_sizes, texel(low - 1u), 0).y);
}

%%morph%%
%%wind%%
void main() {
  v_world = u_origin + u_step * morphed(a_steps, a_end, u_share);
  if (u_has_sizes) {
    vec3 centre = uintBitsToFloat(texelFetch(u_leaves, texel(2u * a_leaf + 1u), 0).xyz);
    v_world = centre + (v_world - centre) * scale_of(a_leaf);
  }
  v_normal = unfolded(a_octahedral);
  if (u_sways) {
    v_world = swayed(v_world, a_pivot, a_along, a_segment);
    // A normal turns as an arm does.
    v_normal = swayed(a_pivot + v_normal, a_pivot, 0.0, a_segment) - a_pivot;
  }
  v_uv = a_uv;
  v_color = a_color;
  gl_Position = u_clip_from_world * vec4(v_world, 1.0);
}
