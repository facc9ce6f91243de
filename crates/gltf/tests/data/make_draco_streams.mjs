// The two squares of tests/gltf_read/small_tree.rs, by both methods of the reference encoder: positions as they
// are, texture coordinates x, y in 10 bits, colours of bytes with the vertex's number in red.
import draco3d from 'draco3dgltf';
import fs from 'fs';
const draco = await draco3d.createEncoderModule();
const P = [], T = [], C = [];
for (const z of [0, 2]) for (const [x, y] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
  C.push(C.length / 4, 20, 30, 200);
  P.push(x, y, z);
  T.push(x, y);
}
const I = [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7];
for (const [name, method] of [['edgebreaker', draco.MESH_EDGEBREAKER_ENCODING], ['sequential', draco.MESH_SEQUENTIAL_ENCODING]]) {
  const encoder = new draco.Encoder(), builder = new draco.MeshBuilder(), mesh = new draco.Mesh();
  builder.AddFacesToMesh(mesh, I.length / 3, new Uint32Array(I));
  builder.AddFloatAttributeToMesh(mesh, draco.POSITION, P.length / 3, 3, new Float32Array(P));
  builder.AddFloatAttributeToMesh(mesh, draco.TEX_COORD, T.length / 2, 2, new Float32Array(T));
  builder.AddUInt8Attribute(mesh, draco.COLOR, C.length / 4, 4, new Uint8Array(C));
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco.TEX_COORD, 10);
  const out = new draco.DracoInt8Array();
  const length = encoder.EncodeMeshToDracoBuffer(mesh, out);
  const bytes = Buffer.alloc(length);
  for (let i = 0; i < length; ++i) bytes.writeInt8(out.GetValue(i), i);
  fs.writeFileSync(`squares_${name}.drc`, bytes);
}

// A bent sheet of 24 x 24 squares, of which a plain file is several times as large.
{
  const N = 24, P = [], I = [];
  for (let y = 0; y <= N; ++y) for (let x = 0; x <= N; ++x) P.push(x / N, y / N, 0.1 * Math.sin(0.7 * x) * Math.cos(0.5 * y));
  for (let y = 0; y < N; ++y) for (let x = 0; x < N; ++x) {
    const a = y * (N + 1) + x, b = a + N + 1;
    I.push(a, a + 1, b, a + 1, b + 1, b);
  }
  const encoder = new draco.Encoder(), builder = new draco.MeshBuilder(), mesh = new draco.Mesh();
  builder.AddFacesToMesh(mesh, I.length / 3, new Uint32Array(I));
  builder.AddFloatAttributeToMesh(mesh, draco.POSITION, P.length / 3, 3, new Float32Array(P));
  encoder.SetEncodingMethod(draco.MESH_EDGEBREAKER_ENCODING);
  encoder.SetAttributeQuantization(draco.POSITION, 11);
  const out = new draco.DracoInt8Array();
  const length = encoder.EncodeMeshToDracoBuffer(mesh, out);
  const bytes = Buffer.alloc(length);
  for (let i = 0; i < length; ++i) bytes.writeInt8(out.GetValue(i), i);
  fs.writeFileSync('sheet_edgebreaker.drc', bytes);
}
