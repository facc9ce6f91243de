// A breeze for what says what it hangs on: the uniforms of wind.glsl, as secateur_runtime::wind makes them.

// Where it blows to, x and z, a unit vector.
const BREEZE_TOWARD = [0.8, 0.6];
// What is as far along the wood as the plant is high moves by at most this share of the height.
const BREEZE_BEND = 0.06;
// Leaves turn by at most this.
const BREEZE_FLUTTER_DEGREES = 25;
// How long a gust takes to pass.
const GUST_S = 5;
// The height of a wave, of a unit vector, and the most that waves make together.
const [WAVE_UNIT, TOWARD_UNIT, MOST_WAVES] = [16384, 256, 5];

// At a time, for a plant of this height in metres.
const breeze = (height, seconds) => {
  const [x, z] = BREEZE_TOWARD;
  return {
    toward: [Math.round(x * TOWARD_UNIT), Math.round(z * TOWARD_UNIT)],
    axis: [z, -x],
    turns: Math.floor(((seconds / GUST_S) % 65536) * 65536),
    bend: BREEZE_BEND / (height * MOST_WAVES * WAVE_UNIT * TOWARD_UNIT),
    flutter: Math.tan((BREEZE_FLUTTER_DEGREES * Math.PI) / 360) / WAVE_UNIT,
  };
};

// Five words a vertex, as attributes of the bound vertex array: the pivot, how far it is along the wood,
// and the number of the piece of wood.
const bindHolds = (gl, words) => {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, words, gl.STATIC_DRAW);
  for (const location of [5, 6, 7]) gl.enableVertexAttribArray(location);
  gl.vertexAttribPointer(5, 3, gl.FLOAT, false, 20, 0);
  gl.vertexAttribPointer(6, 1, gl.FLOAT, false, 20, 12);
  gl.vertexAttribIPointer(7, 1, gl.UNSIGNED_INT, 20, 16);
  return buffer;
};
