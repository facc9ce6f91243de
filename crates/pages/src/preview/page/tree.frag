#version 300 es
// The light of glTF's own material model (specification 2.0, appendix B) for what
// is no metal, under a sun and a sky: what a standard client shows of the file.
precision highp float;
precision highp int;

in vec3 v_world;
in vec3 v_normal;
in vec2 v_uv;
in vec4 v_color;

uniform vec4 u_color;
// Instead of the light, for wireframes; or what the light falls on.
uniform vec4 u_plain;
uniform sampler2D u_texture;
uniform sampler2D u_normal_map;
uniform float u_normal_scale;
uniform float u_cutoff;
uniform float u_roughness;
uniform vec3 u_eye;
uniform vec3 u_to_sun;
uniform vec3 u_sun;
uniform vec3 u_sky;
uniform vec3 u_ground;
// One bit each.
uniform int u_has;
const int TEXTURE = 1, NORMALS = 2, NORMAL_MAP = 4, UNLIT = 8, SEE_THROUGH = 16, FRINGE = 32, PLAIN = 64, TINT = 128;

out vec4 color;

const float PI = 3.14159265;
// What reflects head on of what is no metal.
const float F0 = 0.04;

bool has(int bit) { return (u_has & bit) != 0; }

// Tangents from how position and texture coordinates change over the screen,
// since few files carry them.
vec3 bent(vec3 normal, float side) {
  vec3 px = dFdx(v_world), py = dFdy(v_world);
  vec2 ux = dFdx(v_uv), uy = dFdy(v_uv);
  vec3 across = cross(py, normal), along = cross(normal, px);
  vec3 tangent = across * ux.x + along * uy.x;
  vec3 bitangent = across * ux.y + along * uy.y;
  float size = max(dot(tangent, tangent), dot(bitangent, bitangent));
  if (size == 0.0) return normal;
  vec3 map = texture(u_normal_map, v_uv).xyz * 2.0 - 1.0;
  // Green points up, v down.
  map.xy *= vec2(u_normal_scale, -u_normal_scale) * side;
  return normalize((tangent * map.x + bitangent * map.y) * inversesqrt(size) + normal * map.z);
}

vec3 lit(vec3 base) {
  float side = gl_FrontFacing ? 1.0 : -1.0;
  // Without normals each face is flat.
  vec3 flat_normal = normalize(cross(dFdx(v_world), dFdy(v_world)));
  vec3 normal = has(NORMALS) ? normalize(v_normal) * side : flat_normal;
  float alpha = max(u_roughness, 0.05);
  alpha *= alpha;
  if (has(NORMAL_MAP)) normal = bent(normal, has(NORMALS) ? side : 1.0);

  vec3 sky = mix(u_ground, u_sky, 0.5 + 0.5 * normal.y);
  vec3 to_eye = normalize(u_eye - v_world);
  vec3 half_way = normalize(u_to_sun + to_eye);
  float nl = max(dot(normal, u_to_sun), 0.0);
  float nv = max(dot(normal, to_eye), 0.0);
  float nh = max(dot(normal, half_way), 0.0);
  float a2 = alpha * alpha;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float distribution = a2 / (PI * d * d);
  float visibility = 0.5 / max(nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2), 1e-6);
  float fresnel = F0 + (1.0 - F0) * pow(1.0 - max(dot(to_eye, half_way), 0.0), 5.0);
  // What is reflected does not get under the surface, of the sky's light either.
  float of_sky = F0 + (1.0 - F0) * (1.0 - u_roughness) * pow(1.0 - nv, 5.0);
  vec3 under = sky * (1.0 - of_sky) + nl * u_sun * (1.0 - fresnel);
  return under * base / PI + nl * u_sun * distribution * visibility * fresnel;
}

vec3 to_srgb(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));
}

void main() {
  vec4 base = u_color * v_color;
  if (has(TEXTURE)) base *= texture(u_texture, v_uv);
  if (base.a < u_cutoff) discard;
  // Blended leaves: what is more solid than not hides what is behind; the fringe
  // is drawn over everything afterwards.
  if (has(FRINGE) && base.a >= 0.5) discard;
  if (has(PLAIN)) {
    color = u_plain;
    return;
  }
  if (has(TINT)) base.rgb = mix(u_plain.rgb, base.rgb, 0.2);
  vec3 light = has(UNLIT) ? base.rgb : lit(base.rgb);
  color = vec4(to_srgb(light), has(SEE_THROUGH) ? base.a : 1.0);
}
