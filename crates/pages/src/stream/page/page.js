// The page: a stream that arrives, the plant of what is there of it, and what the controls do.

const $ = (id) => document.getElementById(id);
const count = (n) => n.toLocaleString("en-US");
const size = (n) => n < 1e6 ? `${(n / 1e3).toFixed(0)} kB` : `${(n / 1e6).toFixed(2)} MB`;

const facts = JSON.parse($("facts").textContent);
const canvas = $("canvas");
const CHUNK = 1 << 16;
// How long a chunk takes to arrive that is in the page already.
const CHUNK_MS = 120;

const state = {
  // All bytes that have come, and how many of them are shown.
  bytes: new Uint8Array(facts.bytes),
  arrived: 0,
  shown: 0,
  isReceiving: true,
  source: "",
  show: { leaves: true, wood: true, wire: false },
  // The wind, and for how long it has blown.
  isWindy: false,
  windSeconds: 0,
};
let reader = new PlantReader();
let renderer = null;
let chain = null;
let isAsked = false;

let drawnAt = 0;
const draw = (now) => {
  isAsked = false;
  const step = Math.min(now - drawnAt, 100);
  drawnAt = now;
  if (!renderer || !chain) return;
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const box = { x: 0, y: 0, width, height };
  if (state.isWindy) state.windSeconds += step / 1000;
  const wind = state.isWindy ? breeze(chain.size[1], state.windSeconds) : null;
  renderer.draw({ level: 0, steps: null }, chain.closeUp(orbit, width / height), box, state.show, wind);
  if (state.isWindy) ask();
};
const ask = () => {
  if (isAsked) return;
  isAsked = true;
  requestAnimationFrame(draw);
};
const orbit = new Orbit(canvas, ask);

// Positions are floats here, not steps in a box.
const meshOf = ({ arrays, vertices, material, is_foliage }) => {
  const { gl } = renderer;
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  const buffers = [];
  const attribute = (location, values, size, type, isNormalized) => {
    if (!values) return;
    const buffer = gl.createBuffer();
    buffers.push(buffer);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, isNormalized, 0, 0);
  };
  attribute(0, arrays.positions, 3, gl.FLOAT, false);
  attribute(1, arrays.normals, 2, gl.SHORT, true);
  attribute(2, arrays.uvs, 2, gl.FLOAT, false);
  attribute(3, arrays.colors, 4, gl.UNSIGNED_SHORT, true);
  if (arrays.holds) buffers.push(bindHolds(gl, arrays.holds));
  const triangles = gl.createBuffer();
  buffers.push(triangles);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangles);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, arrays.indices, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  const free = () => {
    buffers.forEach((buffer) => gl.deleteBuffer(buffer));
    gl.deleteVertexArray(array);
  };
  return {
    material,
    is_foliage,
    vertices: array,
    triangles: arrays.indices.length / 3,
    origin: [0, 0, 0],
    step: [1, 1, 1],
    normals: arrays.normals,
    uvs: arrays.uvs,
    colors: arrays.colors,
    holds: arrays.holds,
    buffers: { triangles, lines: null },
    corners: arrays.indices,
    free,
  };
};

const say = () => {
  const total = facts.bytes;
  $("received").value = Math.round((1000 * state.shown) / total);
  $("received-text").textContent = `${size(state.shown)} of ${size(total)}`;
  $("received").setAttribute("aria-valuetext", $("received-text").textContent);
  $("fps").textContent = state.source;
  $("play").setAttribute("aria-pressed", state.isReceiving);
  $("leaves").setAttribute("aria-pressed", state.show.leaves);
  $("wood").setAttribute("aria-pressed", state.show.wood);
  $("wind").setAttribute("aria-pressed", state.isWindy);
  $("wind").hidden = !renderer?.canSway;
  document.querySelectorAll("#pieces tr").forEach((row, k) => row.classList.toggle("current", k === reader.pieces - 1));
  if (!reader.head) return;
  const line = (tag, text) => {
    const element = document.createElement(tag);
    element.textContent = text;
    return element;
  };
  const leaves = `${count(reader.level.leaves)} of ${count(reader.head.leaves)} leaves`;
  const triangles = `${count(reader.triangles)} of ${count(reader.head.triangles)} triangles`;
  const pieces = `${reader.pieces} of ${reader.head.pieces} pieces`;
  $("name").replaceChildren(line("strong", pieces), line("span", leaves), line("span", triangles));
  ask();
};

const tell = (text) => {
  $("message").hidden = text === "";
  $("message").textContent = text;
};

// Puts what the reader has where the renderer draws it.
const show = async () => {
  if (!renderer) {
    renderer = new Renderer(canvas);
    const { textures, materials } = reader.head;
    const bitmaps = await Promise.all(textures.map((entry) => bitmapOf(entry, reader.pictures)));
    renderer.use(modelOf({ textures, materials, levels: [], continuous: null }, null, bitmaps));
    renderer.levels[0] = [];
    const { low, high, reach } = reader.head;
    chain = new Chain({ screen: [1080, 60], low, high, reach, levels: [{ facts: { distance: 0 }, surfaces: [] }] });
  }
  renderer.levels[0].forEach((mesh) => mesh.free());
  const surfaces = reader.arrays().map(meshOf);
  renderer.levels[0] = surfaces;
  renderer.scene.levels = [{ surfaces }];
  tell("");
};

// One change after the other, however they are asked for.
let queue = Promise.resolve();
const inTurn = (work) => {
  queue = queue.then(work).catch((error) => tell(error.message));
  return queue;
};

// Shows the plant of the stream's first bytes, this number of them.
const showBytes = (bytes) => inTurn(async () => {
  if (bytes < state.shown) {
    reader = new PlantReader();
    state.shown = 0;
  }
  const isNew = await reader.push(state.bytes.subarray(state.shown, bytes));
  state.shown = bytes;
  if (isNew) await show();
  say();
});

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

const arrive = async (chunk) => {
  state.bytes.set(chunk, state.arrived);
  state.arrived += chunk.length;
  while (!state.isReceiving) await pause(50);
  await showBytes(state.arrived);
};

// From the file beside the page, as the network brings it; false where there is none to be had.
const fromFile = async () => {
  if (!facts.beside || !location.protocol.startsWith("http")) return false;
  const response = await fetch(facts.beside).catch(() => null);
  if (!response?.ok || !response.body) return false;
  state.source = facts.beside;
  const chunks = response.body.getReader();
  for (;;) {
    const { done, value } = await chunks.read();
    if (done) return true;
    if (state.arrived + value.length > facts.bytes) throw new Error(`${facts.beside} is another stream than this page's.`);
    await arrive(value);
  }
};

const fromPage = async () => {
  state.source = "in this page";
  const bytes = bytesOf("stream");
  for (let at = 0; at < bytes.length; at += CHUNK) {
    await arrive(bytes.subarray(at, at + CHUNK));
    await pause(CHUNK_MS);
  }
};

const listen = () => {
  $("received").addEventListener("input", (e) => {
    state.isReceiving = false;
    showBytes(Math.min(Math.round((e.target.value / 1000) * facts.bytes), state.arrived));
  });
  $("play").addEventListener("click", async () => {
    state.isReceiving = !state.isReceiving;
    if (state.isReceiving) await showBytes(state.arrived);
    say();
  });
  $("again").addEventListener("click", async () => {
    state.isReceiving = false;
    const arrived = state.arrived;
    for (const piece of facts.pieces.filter((piece) => piece.bytes <= arrived)) {
      await showBytes(piece.bytes);
      await pause(CHUNK_MS);
    }
    state.isReceiving = true;
    say();
  });
  for (const id of ["leaves", "wood"]) {
    $(id).addEventListener("click", () => {
      state.show[id] = !state.show[id];
      say();
    });
  }
  $("wind").addEventListener("click", () => {
    state.isWindy = !state.isWindy;
    say();
  });
  new ResizeObserver(ask).observe(canvas);
};

const fillTable = () => {
  $("pieces").replaceChildren(...facts.pieces.map((piece, k) => {
    const row = document.createElement("tr");
    const head = document.createElement("th");
    head.scope = "row";
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = k + 1;
    button.addEventListener("click", () => {
      state.isReceiving = false;
      if (piece.bytes <= state.arrived) showBytes(piece.bytes);
    });
    head.append(button);
    const cells = [size(piece.bytes), count(piece.leaves), count(piece.triangles)].map((text) => {
      const cell = document.createElement("td");
      cell.textContent = text;
      return cell;
    });
    row.append(head, ...cells);
    return row;
  }));
};

const start = async () => {
  fillTable();
  listen();
  say();
  try {
    if (!await fromFile()) await fromPage();
    document.documentElement.dataset.ready = Math.round(performance.now());
  } catch (error) {
    tell(error.message);
  }
};
window.streaming = { state, facts, showBytes, reader: () => reader, orbit };
start();
