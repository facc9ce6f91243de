// wind.wgsl for WebGL 2 and OpenGL (GLSL ES 3.00): paste it into a vertex shader, and call `swayed` with
// what `secateur grow` writes beside each vertex.

// Where it blows to, x and z, a unit vector in 1/256.
uniform ivec2 u_wind_toward;
// What leaves turn about, x and z, a unit vector.
uniform vec2 u_wind_axis;
// The time in 1/65536 turns of the slow wave.
uniform uint u_wind_turns;
// How far wood moves, in metres for each square metre along it, by 16384 and by 256.
uniform float u_wind_bend;
// The tangent of half the angle by which a leaf turns at most, by 16384; 0 for wood.
uniform float u_wind_flutter;

int wind_wave(uint turns) {
  int part = int(turns & 0x7fffu);
  int height = (part * (32768 - part)) >> 14;
  return (turns & 0x8000u) != 0u ? -height : height;
}

ivec3 wind_cells(vec3 point) {
  return ivec3(floor(clamp(point, vec3(-1000.0), vec3(1000.0)) * 1024.0));
}

vec3 wind_bend(vec3 pivot, float along) {
  ivec3 cells = wind_cells(pivot);
  uint at = uint((u_wind_toward.x * cells.x + u_wind_toward.y * cells.z) >> 8);
  int gust = wind_wave(u_wind_turns - at);
  int shiver = wind_wave(3u * u_wind_turns - 8u * at);
  float amount = float(32768 + 2 * gust + shiver) * (u_wind_bend * (along * along));
  return vec3(amount * float(u_wind_toward.x), 0.0, amount * float(u_wind_toward.y));
}

float wind_half_turn(vec3 pivot, uint segment) {
  uvec3 at = uvec3(wind_cells(pivot));
  uint own = segment * 0x9e3779b1u + at.x * 0x85ebca77u + at.y * 0xc2b2ae3du + at.z * 0x27d4eb2fu;
  return float(wind_wave(7u * u_wind_turns + (own >> 16))) * u_wind_flutter;
}

// position: the vertex; pivot: _WIND_PIVOT; along: _WIND_ALONG; segment: x + 65536 y of _WIND_SEGMENT.
vec3 swayed(vec3 position, vec3 pivot, float along, uint segment) {
  vec3 arm = position - pivot;
  float h = wind_half_turn(pivot, segment);
  vec3 axis = vec3(u_wind_axis.x, 0.0, u_wind_axis.y);
  vec3 across = cross(axis, arm);
  vec3 turn = (2.0 / (1.0 + h * h)) * (h * across + h * h * cross(axis, across));
  return pivot + wind_bend(pivot, along) + (arm + turn);
}
