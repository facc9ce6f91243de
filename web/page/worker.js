// The engine's side: everything that takes time happens here, never in the page.

let tree = null;
// What was made of the tree, by its settings.
const made = new Map();
let hasEngine = null;

const forget = () => {
  for (const thing of made.values()) thing.free();
  made.clear();
  tree?.free();
  tree = null;
};

// Arrays of a picture, which move to the page without a copy.
const pictureOf = (picture) => {
  const packed = { scene: JSON.parse(picture.scene()), geometry: picture.geometry(), textures: picture.textures() };
  picture.free();
  return packed;
};

const sha256Of = async (bytes) => {
  // There is none in pages that came without encryption.
  const hash = await globalThis.crypto?.subtle?.digest("SHA-256", bytes);
  return hash ? [...new Uint8Array(hash)].map((byte) => byte.toString(16).padStart(2, "0")).join("") : null;
};

const opened = async (name, bytes, { leaves, notPlant, wind }) => {
  forget();
  const sha256 = await sha256Of(bytes);
  tree = new wasm_bindgen.Tree(name, bytes, JSON.stringify(leaves), JSON.stringify(notPlant), wind);
  return { name, sha256, inspection: JSON.parse(tree.inspection()), problem: tree.problem() ?? null, leafPieces: JSON.parse(tree.leafPieces()), otherPieces: JSON.parse(tree.otherPieces()), picture: pictureOf(tree.picture()) };
};

// Several pieces or parts: { items, triangles, picture }, or null for none.
const chosenOf = (chosen) => {
  if (!chosen) return null;
  const value = { items: JSON.parse(chosen.items()), triangles: chosen.triangles(), picture: pictureOf(chosen.picture()) };
  chosen.free();
  return value;
};

const base64Of = (bytes) => {
  let text = "";
  for (let at = 0; at < bytes.length; at += 0x8000) text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
  return btoa(text);
};

const TYPES = { png: "image/png", jpg: "image/jpeg", jpeg: "image/jpeg", webp: "image/webp", ktx2: "image/ktx2" };

// A .gltf with the files that it names put into it.
const joined = async (gltf, files) => {
  let root;
  try {
    root = JSON.parse(await gltf.text());
  } catch {
    throw `${gltf.name}: it is no JSON, as a .gltf must be`;
  }
  for (const item of [...(root.buffers ?? []), ...(root.images ?? [])]) {
    const uri = item?.uri;
    if (typeof uri !== "string" || uri.startsWith("data:")) continue;
    const wanted = decodeURIComponent(uri).split(/[\\/]/).at(-1);
    const file = files.find((other) => other.name === wanted);
    if (!file) throw `${gltf.name}: it needs ${wanted}, which was not dropped with it: drop all of its files together`;
    const type = TYPES[wanted.split(".").at(-1).toLowerCase()] ?? "application/octet-stream";
    item.uri = `data:${type};base64,${base64Of(new Uint8Array(await file.arrayBuffer()))}`;
  }
  return new TextEncoder().encode(JSON.stringify(root));
};

// The plant among files: the first .glb or .gltf.
const bytesOf = async (files) => {
  const plant = files.find((file) => /\.(glb|gltf)$/i.test(file.name));
  if (!plant) throw `${files[0]?.name ?? "nothing"}: this is no .glb or .gltf file; other formats can be exported to glTF by Blender`;
  const isText = /\.gltf$/i.test(plant.name);
  return [plant.name, isText ? await joined(plant, files) : new Uint8Array(await plant.arrayBuffer())];
};

const tellOf = (id) => {
  let last = 0;
  return (stage, share) => {
    const now = performance.now();
    if (stage === "step" && now - last < 50) return;
    last = now;
    postMessage({ id, progress: { stage, share } });
  };
};

const calls = {
  species: () => wasm_bindgen.species(),
  async open({ source, ...opening }) {
    if (source.grown) {
      const { species, leaves, seed } = source.grown;
      return opened(`${species}.glb`, wasm_bindgen.grow(species, leaves, seed), opening);
    }
    const [name, bytes] = await bytesOf(source.files);
    return opened(name, bytes, opening);
  },
  make({ key, kind, settings }, id) {
    const tell = tellOf(id);
    if (!made.has(key)) made.set(key, kind === "level" ? tree.level(JSON.stringify(settings), tell) : tree.levels(JSON.stringify(settings), tell));
    const result = made.get(key);
    return { report: JSON.parse(result.report()), picture: pictureOf(result.picture()) };
  },
  // The connected piece that the first of these rays meets that meets any: { number, triangles, picture }, or null.
  pieceAt({ place, rays }) {
    let piece;
    for (const { from, along } of rays) if ((piece = tree.pieceAt(place, new Float64Array(from), new Float64Array(along)))) break;
    if (!piece) return null;
    const value = { number: piece.number(), triangles: piece.triangles(), picture: pictureOf(piece.picture()) };
    piece.free();
    return value;
  },
  // The pieces of a part, most triangles first: [number, triangles].
  pieces: ({ place }) => JSON.parse(tree.pieces(place)),
  piecesAt: ({ place, numbers }) => chosenOf(tree.piecesAt(place, new Uint32Array(numbers))),
  // What of the plant lies for the most part in a loop.
  lasso: ({ camera, corners, ofParts }) => chosenOf(tree.lasso(new Float64Array(camera), new Float64Array(corners), ofParts)),
  // A level that nobody takes home.
  coarse({ settings }, id) {
    const level = tree.level(JSON.stringify(settings), tellOf(id));
    const value = { report: JSON.parse(level.report()), picture: pictureOf(level.picture()) };
    level.free();
    return value;
  },
  // Bytes to take home; what they are of was made before.
  take({ key, what, layout, number }) {
    const result = made.get(key);
    if (what === "level") return result.glb();
    if (what === "file") return result.file(layout, number);
    if (what === "preview") return new TextEncoder().encode(result.preview());
    return result.zip(layout, true);
  },
};

const buffersOf = (value) => {
  if (value instanceof Uint8Array) return [value.buffer];
  const { picture } = value ?? {};
  return picture ? [picture.geometry.buffer, picture.textures.buffer] : [];
};

onmessage = async ({ data }) => {
  if (data.engine) {
    hasEngine = wasm_bindgen({ module_or_path: data.engine });
    return;
  }
  const { id, call, given } = data;
  try {
    await hasEngine;
    const value = await calls[call](given, id);
    postMessage({ id, value }, buffersOf(value));
  } catch (error) {
    if (typeof error === "string") return postMessage({ id, error });
    // A trap: the engine's memory is not to be trusted any more.
    const said = wasm_bindgen.lastPanic?.() || String(error);
    postMessage({ id, error: `The engine failed, or had too little memory: ${said}`, isBroken: true });
  }
};
