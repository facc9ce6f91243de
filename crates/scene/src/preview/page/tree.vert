#version 300 es
// Unpacks a vertex; see geometry.rs for how it was packed.
layout(location = 0) in vec3 a_steps;
layout(location = 1) in vec2 a_octahedral;
layout(location = 2) in vec2 a_uv;
layout(location = 3) in vec4 a_color;

uniform mat4 u_clip_from_world;
uniform vec3 u_origin;
uniform vec3 u_step;

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

void main() {
  v_world = u_origin + u_step * a_steps;
  v_normal = unfolded(a_octahedral);
  v_uv = a_uv;
  v_color = a_color;
  gl_Position = u_clip_from_world * vec4(v_world, 1.0);
}
