// A camera that a plant fills, whichever way it is turned.

const MOST_SAMPLES = 4000;
// Room about it.
const MARGIN = 1.05;

// How far vertices are from the plant's upright axis, and how high above its middle.
const profileOf = (meshes, center) => {
  const all = meshes.reduce((sum, mesh) => sum + mesh.vertexCount, 0);
  const stride = Math.max(1, Math.ceil(all / MOST_SAMPLES));
  const profile = [];
  for (const { origin, step, positions, vertexCount } of meshes) {
    for (let k = 0; k < vertexCount; k += stride) {
      const [x, y, z] = [0, 1, 2].map((axis) => origin[axis] + step[axis] * positions[4 * k + axis] - center[axis]);
      profile.push([Math.hypot(x, z), y]);
    }
  }
  return profile;
};

// Half the height that a picture must show at the middle of the plant, seen from a distance, turned as may be.
const halfHeightOf = (profile, pitch, distance, aspect) => {
  const [sin, cos] = [Math.sin(pitch), Math.cos(pitch)];
  let half = 1e-9;
  for (const [radius, y] of profile) {
    for (const side of [radius, -radius]) {
      const up = Math.abs(y * cos - side * sin);
      const nearer = Math.min(side * cos + y * sin, 0.8 * distance);
      half = Math.max(half, (up * distance) / (distance - nearer));
    }
    half = Math.max(half, (radius * distance) / Math.sqrt(Math.max(distance ** 2 - radius ** 2, 0.04 * distance ** 2)) / aspect);
  }
  return MARGIN * half;
};

// The chain's own camera, which leaves room for an upright cylinder, nearer to what is there.
const filled = (chain, profile, orbit, aspect) => {
  const camera = chain.closeUp(orbit, aspect);
  const distance = Math.hypot(...add(camera.eye, times(camera.target, -1)));
  const half = halfHeightOf(profile, orbit.pitch, distance, aspect);
  return { ...camera, tangent: Math.min(camera.tangent, half / distance / orbit.zoom) };
};
