#version 300 es
// How different two pictures look, as a heat map: the distance of their colours in CIE L*a*b*, after the light of
// neighbouring pixels was mixed as the eye mixes it.
precision highp float;

uniform sampler2D u_first;
uniform sampler2D u_second;

out vec4 color;

// The distance that is painted lightest; 2.3 is what people just see.
const float LIGHTEST = 60.0;
// The colours of the legend, evenly spaced.
const vec3 HEAT[5] = vec3[5](
  vec3(0.03, 0.02, 0.08), vec3(0.32, 0.07, 0.43), vec3(0.78, 0.22, 0.33), vec3(0.98, 0.6, 0.15), vec3(1.0, 0.98, 0.78));

vec3 to_linear(vec3 c) {
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, vec3(lessThanEqual(c, vec3(0.04045))));
}

vec3 light(sampler2D picture, ivec2 at) {
  ivec2 last = textureSize(picture, 0) - 1;
  vec3 sum = vec3(0.0);
  for (int y = -1; y <= 1; y++) {
    for (int x = -1; x <= 1; x++) {
      float weight = float((2 - abs(x)) * (2 - abs(y)));
      sum += weight * to_linear(texelFetch(picture, clamp(at + ivec2(x, y), ivec2(0), last), 0).rgb);
    }
  }
  return sum / 16.0;
}

// Of linear sRGB, under its own white.
vec3 lab(vec3 c) {
  vec3 xyz = vec3(
    dot(c, vec3(0.4339, 0.3762, 0.1899)), dot(c, vec3(0.2126, 0.7152, 0.0722)), dot(c, vec3(0.0178, 0.1095, 0.8727)));
  vec3 f = mix(pow(max(xyz, 1e-9), vec3(1.0 / 3.0)), xyz * 7.787 + 16.0 / 116.0, vec3(lessThan(xyz, vec3(0.008856))));
  return vec3(116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float seen = distance(lab(light(u_first, at)), lab(light(u_second, at)));
  float place = 4.0 * clamp(seen / LIGHTEST, 0.0, 1.0);
  int below = min(int(place), 3);
  color = vec4(mix(HEAT[below], HEAT[below + 1], place - float(below)), 1.0);
}
