// Matrices as WebGL has them, column by column, and vectors of three.

const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const dot = ([a, b, c], [x, y, z]) => a * x + b * y + c * z;
const add = ([a, b, c], [x, y, z]) => [a + x, b + y, c + z];
const times = (v, factor) => v.map((x) => x * factor);
const unit = (v) => times(v, 1 / Math.hypot(...v));

const product = (a, b) => Float32Array.from({ length: 16 }, (_, k) => {
  let sum = 0;
  for (let j = 0; j < 4; j++) sum += a[4 * j + (k % 4)] * b[4 * (k >> 2) + j];
  return sum;
});

// From the world to the camera, which looks along its -z.
const lookAt = (eye, target) => {
  const back = unit(add(eye, times(target, -1)));
  const right = unit(cross([0, 1, 0], back));
  const up = cross(back, right);
  const at = [right, up, back].map((axis) => -dot(axis, eye));
  return [
    right[0], up[0], back[0], 0,
    right[1], up[1], back[1], 0,
    right[2], up[2], back[2], 0,
    ...at, 1,
  ];
};

const perspective = (tangent, aspect, near, far) => [
  1 / (tangent * aspect), 0, 0, 0,
  0, 1 / tangent, 0, 0,
  0, 0, (far + near) / (near - far), -1,
  0, 0, (2 * far * near) / (near - far), 0,
];
