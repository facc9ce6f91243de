import { MeshoptEncoder as E } from 'meshoptimizer/encoder';
import { MeshoptDecoder as D } from 'meshoptimizer/decoder';
import fs from 'fs';
await E.ready; await D.ready;
let seed = 12345; const rnd = () => { seed = (Math.imul(seed, 1103515245) + 12345) >>> 0; return seed / 4294967296; };
const out = [];
function add(name, mode, filter, count, stride, enc) {
  const dec = new Uint8Array(count * stride);
  D.decodeGltfBuffer(dec, count, stride, enc, mode, filter);
  out.push({ name, mode, filter, count, stride, enc: Buffer.from(enc), dec: Buffer.from(dec) });
}
const bytes = (a) => new Uint8Array(a.buffer, a.byteOffset, a.byteLength);
// a grid of 11 x 7 vertices
const W = 11, H = 7, N = W * H;
const idx = [];
for (let y = 0; y + 1 < H; ++y) for (let x = 0; x + 1 < W; ++x) { const a = y * W + x; idx.push(a, a + 1, a + W, a + W, a + 1, a + W + 1); }
// some loose triangles in no order
for (let k = 0; k < 20; ++k) idx.push(Math.floor(rnd() * N), Math.floor(rnd() * N), Math.floor(rnd() * N));
const i32 = new Uint32Array(idx), i16 = new Uint16Array(idx);
for (const [n, a, s] of [['32', i32, 4], ['16', i16, 2]]) {
  add('triangles' + n, 'TRIANGLES', 'NONE', a.length, s, E.encodeGltfBuffer(bytes(a), a.length, s, 'TRIANGLES'));
  add('indices' + n, 'INDICES', 'NONE', a.length, s, E.encodeGltfBuffer(bytes(a), a.length, s, 'INDICES'));
}
for (const version of [0, 1]) {
  // positions: shorts with padding, 8 bytes
  const p = new Uint16Array(N * 4);
  for (let k = 0; k < N; ++k) { p[4 * k] = (k % W) * 300 + rnd() * 9; p[4 * k + 1] = Math.floor(k / W) * 500; p[4 * k + 2] = rnd() * 65535; }
  for (const level of [0, 2]) add(`shorts-v${version}-l${level}`, 'ATTRIBUTES', 'NONE', N, 8, E.encodeVertexBufferLevel(bytes(p), N, 8, level, version));
  // floats, 12 bytes
  const f = new Float32Array(N * 3);
  for (let k = 0; k < 3 * N; ++k) f[k] = Math.sin(k * 0.1) * 10;
  for (const level of [0, 3]) add(`floats-v${version}-l${level}`, 'ATTRIBUTES', 'NONE', N, 12, E.encodeVertexBufferLevel(bytes(f), N, 12, level, version));
  // wide random elements, 64 bytes: literal bytes, several blocks
  const r = new Uint8Array(150 * 64);
  for (let k = 0; k < r.length; ++k) r[k] = (k % 64) < 16 ? rnd() * 256 : (k % 64) < 32 ? rnd() * 3 : 7;
  add(`wide-v${version}`, 'ATTRIBUTES', 'NONE', 150, 64, E.encodeVertexBufferLevel(r, 150, 64, 2, version));
  // one element
  add(`one-v${version}`, 'ATTRIBUTES', 'NONE', 1, 4, E.encodeVertexBufferLevel(r.slice(0, 4), 1, 4, 2, version));
  // filters
  const unit = new Float32Array(N * 4), quat = new Float32Array(N * 4);
  for (let k = 0; k < N; ++k) {
    let v = [rnd() - .5, rnd() - .5, rnd() - .5], l = Math.hypot(...v); unit.set([...v.map(x => x / l), rnd() < .5 ? -1 : 1], 4 * k);
    let q = [rnd() - .5, rnd() - .5, rnd() - .5, rnd() - .5], m = Math.hypot(...q); quat.set(q.map(x => x / m), 4 * k);
  }
  const enc = (name, filter, data, stride, count = N) => add(`${name}-v${version}`, 'ATTRIBUTES', filter, count, stride, E.encodeVertexBufferLevel(data, count, stride, 2, version));
  enc('oct8', 'OCTAHEDRAL', E.encodeFilterOct(unit, N, 4, 8), 4);
  enc('oct12', 'OCTAHEDRAL', E.encodeFilterOct(unit, N, 8, 12), 8);
  enc('quat', 'QUATERNION', E.encodeFilterQuat(quat, N, 8, 14), 8);
  enc('exp', 'EXPONENTIAL', E.encodeFilterExp(f, N, 12, 15, 'SharedVector'), 12);
  if (version == 1 && E.encodeFilterColor) { const c = new Float32Array(N * 4).map(() => rnd()); enc('color8', 'COLOR', E.encodeFilterColor(c, N, 4, 8), 4); enc('color12', 'COLOR', E.encodeFilterColor(c, N, 8, 12), 8); }
}
// file: per case: u8 mode (0 ATTRIBUTES, 1 TRIANGLES, 2 INDICES), u8 filter (order of the names), u16 name length, u32 count, u32 stride, u32 encoded length, name, encoded, decoded
const modes = ['ATTRIBUTES', 'TRIANGLES', 'INDICES'], filters = ['NONE', 'OCTAHEDRAL', 'QUATERNION', 'EXPONENTIAL', 'COLOR'];
const chunks = [];
for (const c of out) {
  const h = Buffer.alloc(16); h[0] = modes.indexOf(c.mode); h[1] = filters.indexOf(c.filter); h.writeUInt16LE(c.name.length, 2); h.writeUInt32LE(c.count, 4); h.writeUInt32LE(c.stride, 8); h.writeUInt32LE(c.enc.length, 12);
  chunks.push(h, Buffer.from(c.name), c.enc, c.dec);
}
fs.writeFileSync('streams.bin', Buffer.concat(chunks));
console.log(out.map(c => `${c.name} ${c.enc.length}->${c.dec.length} h=${c.enc[0].toString(16)}`).join('\n'), fs.statSync('streams.bin').size);
