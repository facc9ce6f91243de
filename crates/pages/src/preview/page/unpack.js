// Bytes out of the page: geometry as arrays for WebGL, pictures as bitmaps.

const bytesOf = (id) => {
  const element = document.getElementById(id);
  const text = element.textContent.trim();
  element.remove();
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; k++) bytes[k] = binary.charCodeAt(k);
  return bytes;
};

const inflated = async (bytes) => {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
};

// Each value was stored less the one a stride before it.
const addUp = (values, stride) => {
  for (let k = stride; k < values.length; k++) values[k] += values[k - stride];
  return values;
};

// Arrays of a surface; buffer is the whole geometry.
const unpackSurface = (surface, buffer) => {
  const words = (at, stride) => at === null ? null : addUp(new Uint16Array(buffer, at, surface.vertices * stride), stride);
  const normals = words(surface.normals, 2);
  return {
    positions: words(surface.positions, 4),
    normals: normals && new Int16Array(normals.buffer, normals.byteOffset, normals.length),
    uvs: surface.uvs === null ? null : new Float32Array(buffer, surface.uvs, surface.vertices * 2),
    colors: words(surface.colors, 4),
    holds: surface.holds === null ? null : addUp(new Uint32Array(buffer, surface.holds, surface.vertices * 5), 5),
    ends: surface.ends === undefined ? null : words(surface.ends, 4),
    indices: addUp(new Uint32Array(buffer, surface.indices, surface.triangles * 3), 1),
  };
};

// Colours must come as they are in the file, under an alpha of zero too.
const bitmapOf = (entry, pictures) => {
  const png = new Blob([pictures.subarray(entry.at, entry.at + entry.length)], { type: "image/png" });
  return createImageBitmap(png, { premultiplyAlpha: "none", colorSpaceConversion: "none" });
};
