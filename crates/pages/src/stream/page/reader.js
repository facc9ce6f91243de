// Reads a stream of a plant as it arrives; secateur_pages::stream describes it.

const MAGIC = "secateur stream\0";
const VERSION = 2;
const START_BYTES = 36;
const PIECE_HEAD_BYTES = 16;

class PlantReader {
  constructor() {
    this.waiting = new Uint8Array(0);
    this.hasStarted = false;
    this.pieces = 0;
    this.head = null;
    this.pictures = null;
    // By name.
    this.parts = new Map();
    this.level = { steps: 0, leaves: 0, scale: 1 };
  }

  // Takes some bytes, and resolves to whether the plant is another one now.
  async push(bytes) {
    const all = new Uint8Array(this.waiting.length + bytes.length);
    all.set(this.waiting);
    all.set(bytes, this.waiting.length);
    let at = 0;
    const view = new DataView(all.buffer);
    if (!this.hasStarted) {
      if (all.length < START_BYTES) {
        this.waiting = all;
        return false;
      }
      if (String.fromCharCode(...all.subarray(0, 16)) !== MAGIC) throw new Error("This is no stream of a plant.");
      const version = view.getUint32(16, true);
      if (version !== VERSION) throw new Error(`The stream is of version ${version}; this page reads version ${VERSION}.`);
      this.tag = view.getUint32(20, true);
      this.hasStarted = true;
      at = START_BYTES;
    }
    let isNew = false;
    while (at + PIECE_HEAD_BYTES <= all.length) {
      const [number, tag, packed, unpacked] = [0, 4, 8, 12].map((k) => view.getUint32(at + k, true));
      if (tag !== this.tag) throw new Error(`Piece ${this.pieces} of the stream is of another tree.`);
      if (number !== this.pieces) throw new Error(`The stream has piece ${number} where piece ${this.pieces} should be.`);
      const begin = at + PIECE_HEAD_BYTES;
      if (begin + packed > all.length) break;
      const body = await inflated(all.subarray(begin, begin + packed));
      if (body.byteLength !== unpacked) throw new Error(`Piece ${number} of the stream cannot be unpacked.`);
      this.follow(body);
      this.pieces += 1;
      isNew = true;
      at = begin + packed;
    }
    this.waiting = all.slice(at);
    return isNew;
  }

  follow(body) {
    let at = 0;
    const take = (Kind, count) => {
      const array = new Kind(body, at, count);
      at += array.byteLength;
      return array;
    };
    if (this.head === null) {
      const [headBytes, picturesBytes] = take(Uint32Array, 2);
      const chunk = (bytes) => {
        const array = new Uint8Array(body, at, bytes);
        at += Math.ceil(bytes / 4) * 4;
        return array;
      };
      this.head = JSON.parse(new TextDecoder().decode(chunk(headBytes)));
      this.pictures = chunk(picturesBytes);
    }
    const [steps, leaves] = take(Uint32Array, 2);
    const [scale] = take(Float32Array, 1);
    const [goneCount, resizedCount] = take(Uint32Array, 2);
    for (const name of take(Uint32Array, goneCount)) this.parts.delete(name);
    const resized = take(Uint32Array, resizedCount);
    const scales = take(Float32Array, resizedCount);
    resized.forEach((name, k) => { this.parts.get(name).scale = scales[k]; });
    this.head.surfaces.forEach((surface, number) => this.add(take, surface, number));
    this.level = { steps, leaves, scale };
  }

  add(take, surface, number) {
    const [count, vertices, triangles] = take(Uint32Array, 3);
    const names = take(Uint32Array, count);
    const verticesOf = take(Uint32Array, count);
    const trianglesOf = take(Uint32Array, count);
    const centers = take(Float32Array, 3 * count);
    const scales = take(Float32Array, count);
    const positions = take(Float32Array, 3 * vertices);
    const normals = surface.normals ? take(Int16Array, 2 * vertices) : null;
    const uvs = surface.uvs ? take(Float32Array, 2 * vertices) : null;
    const colors = surface.colors ? take(Uint16Array, 4 * vertices) : null;
    const holds = surface.holds ? take(Uint32Array, 5 * vertices) : null;
    const corners = take(Uint32Array, 3 * triangles);
    let [vertex, triangle] = [0, 0];
    names.forEach((name, k) => {
      const end = vertex + verticesOf[k];
      const part = (array, size) => array && array.subarray(size * vertex, size * end);
      this.parts.set(name, {
        surface: number,
        center: centers.subarray(3 * k, 3 * k + 3),
        scale: scales[k],
        positions: part(positions, 3),
        normals: part(normals, 2),
        uvs: part(uvs, 2),
        colors: part(colors, 4),
        holds: part(holds, 5),
        corners: corners.subarray(3 * triangle, 3 * (triangle + trianglesOf[k])),
      });
      vertex = end;
      triangle += trianglesOf[k];
    });
  }

  get isWhole() {
    return this.head !== null && this.pieces >= this.head.pieces;
  }

  get triangles() {
    let corners = 0;
    for (const part of this.parts.values()) corners += part.corners.length;
    return corners / 3;
  }

  // For each surface its arrays as they are now.
  arrays() {
    const all = this.head.surfaces.map(() => []);
    for (const [name, part] of this.parts) all[part.surface].push([name, part]);
    return all.map((parts, number) => {
      const surface = this.head.surfaces[number];
      const sum = (of) => parts.reduce((total, [, part]) => total + of(part).length, 0);
      const vertices = sum((part) => part.positions) / 3;
      const arrays = {
        positions: new Float32Array(3 * vertices),
        normals: surface.normals ? new Int16Array(2 * vertices) : null,
        uvs: surface.uvs ? new Float32Array(2 * vertices) : null,
        colors: surface.colors ? new Uint16Array(4 * vertices) : null,
        holds: surface.holds ? new Uint32Array(5 * vertices) : null,
        indices: new Uint32Array(sum((part) => part.corners)),
      };
      let [first, corner] = [0, 0];
      for (const [name, part] of parts) {
        const isOriginalLeaf = surface.is_foliage && name <= this.head.leaf_names;
        const scale = isOriginalLeaf ? part.scale * this.level.scale : part.scale;
        part.positions.forEach((x, k) => {
          const center = part.center[k % 3];
          arrays.positions[3 * first + k] = scale === 1 ? x : center + (x - center) * scale;
        });
        for (const [key, size] of [["normals", 2], ["uvs", 2], ["colors", 4], ["holds", 5]]) {
          if (arrays[key]) arrays[key].set(part[key], size * first);
        }
        part.corners.forEach((own, k) => { arrays.indices[corner + k] = first + own; });
        first += part.positions.length / 3;
        corner += part.corners.length;
      }
      return { arrays, vertices, ...surface };
    });
  }
}
