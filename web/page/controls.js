// What buttons, keys, files and fingers do.

const setView = (change) => {
  stage.set(change);
  say();
};

const setMode = (mode) => {
  if (mode !== "plant" && !stage.levels) return;
  choose(null);
  setView({ mode, isLevel: true, picked: null });
};

// B: original and level in turn.
const blink = () => {
  if (!stage.levels) return;
  if (stage.view.mode !== "blink") setView({ mode: "blink", isLevel: false });
  else setView({ isLevel: !stage.view.isLevel });
};

const goTo = (distance) => {
  const { chain } = stage.levels;
  stage.set({ distance: clamp(distance, chain.nearest, chain.farthest) });
  showLevel(null);
};

// Shows a level by its number, or, for null, what the distance has.
const showLevel = (k) => {
  if (decisions.now.shown !== k) return decisions.decide({ shown: k });
  follow();
  say();
};

const chooseLevel = (k) => {
  const result = resultOf();
  if (result && result !== state.coarse && k < result.levels.length) showLevel(k);
};

const keys = {
  b: blink,
  d: () => setMode("difference"),
  r: () => setView({ hasRoles: !stage.view.hasRoles, mode: "plant" }),
  t: () => setView({ isTrueSize: !stage.view.isTrueSize }),
  w: () => stage.canSway && setView({ isWindy: !stage.view.isWindy }),
  a: () => stage.levels && showLevel(null),
  "[": () => stage.levels && goTo(stage.view.distance / 1.06),
  "]": () => stage.levels && goTo(stage.view.distance * 1.06),
  l: () => turnLasso(),
  escape: () => (state.isBusy ? engine.cancel() : turnLasso(false)),
};

const onKey = (event) => {
  const key = event.key.toLowerCase();
  const isText = event.target.matches?.("input:not([type]), input[inputmode], select");
  if ((event.ctrlKey || event.metaKey) && (key === "z" || key === "y")) {
    if (isText || state.isBusy) return;
    event.preventDefault();
    if (key === "y" || event.shiftKey) decisions.redo();
    else decisions.undo();
    return;
  }
  if (event.ctrlKey || event.metaKey || event.altKey || isText || !state.source) return;
  if (/^[0-8]$/.test(key)) chooseLevel(Number(key));
  else keys[key]?.();
};

const filesOf = async (transfer) => {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter((entry) => entry);
  if (!entries.some((entry) => entry.isDirectory)) return [...transfer.files];
  const files = [];
  const walk = async (entry) => {
    if (entry.isFile) {
      const file = await new Promise((done, fail) => entry.file(done, fail));
      files.push(Object.assign(file, { folder: entry.fullPath.slice(1, -entry.name.length) }));
      return;
    }
    const reader = entry.createReader();
    for (let some; (some = await new Promise((done, fail) => reader.readEntries(done, fail))).length > 0; ) for (const inner of some) await walk(inner);
  };
  for (const entry of entries) await walk(entry);
  return files;
};

const openFiles = async (files) => {
  const sources = sourcesOf([...files]);
  if (files.length === 0) return;
  if (state.isBusy) {
    engine.cancel();
    // What is broken off has its end first.
    await new Promise((done) => setTimeout(done));
  }
  openAll(sources);
};

const listenToFiles = () => {
  $("choose").addEventListener("click", () => $("files").click());
  $("files").addEventListener("change", (e) => {
    openFiles(e.target.files);
    e.target.value = "";
  });
  addEventListener("dragover", (e) => {
    e.preventDefault();
    showOpen();
    document.body.classList.add("over");
  });
  const leave = () => {
    document.body.classList.remove("over");
    if (state.source) hideOpen();
  };
  addEventListener("dragleave", (e) => e.relatedTarget === null && leave());
  addEventListener("drop", async (e) => {
    e.preventDefault();
    leave();
    openFiles(await filesOf(e.dataTransfer));
  });
  $("again").addEventListener("click", showOpen);
  $("back").addEventListener("click", hideOpen);
};

// Plants of about 10,000 triangles, by their leaves.
const GROWN = { oak: 3000, birch: 3000, maple: 3000, pine: 3000, willow: 3000, rowan: 400, bush: 2000 };

const listenToStage = () => {
  let pressed = null;
  $("canvas").addEventListener("pointerdown", (e) => {
    pressed = [e.clientX, e.clientY];
  });
  $("canvas").addEventListener("click", (e) => {
    if (!pressed || Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) > 5) return;
    const part = stage.partAt(e.clientX, e.clientY);
    if (part) pick(part.place, stage.raysAt(e.clientX, e.clientY));
  });
  $("canvas").addEventListener("webglcontextlost", () => tell("The browser took the graphics card away: load the page again."));
  for (const button of document.querySelectorAll("[data-mode]")) {
    button.addEventListener("click", () => (button.dataset.mode === "blink" ? blink() : setMode(button.dataset.mode)));
  }
  $("wipe").addEventListener("input", (e) => setView({ wipe: e.target.value / 1000 }));
  $("roles").addEventListener("click", keys.r);
  $("lasso").addEventListener("click", keys.l);
  $("true-size").addEventListener("click", keys.t);
  $("wind").addEventListener("click", keys.w);
  $("reset").addEventListener("click", () => stage.orbit.reset());
  $("background").addEventListener("change", (e) => stage.set({ background: e.target.value }));
};

const start = async () => {
  for (const [species, leaves] of Object.entries(GROWN)) {
    const button = element("button", species[0].toUpperCase() + species.slice(1), { type: "button" });
    button.addEventListener("click", () => open({ grown: { species, leaves, seed: 3 } }));
    $("species").append(button);
  }
  const script = $("worker").textContent;
  engine = new Engine(inflated(bytesOf("engine")).then((bytes) => WebAssembly.compile(bytes)), script);
  listenToFiles();
  listenToStage();
  listenToTarget(decisions, () => trianglesOf(state.inspection));
  $("make").addEventListener("click", make);
  $("close").addEventListener("click", closePlant);
  $("cancel").addEventListener("click", () => engine.cancel());
  $("undo").addEventListener("click", () => decisions.undo());
  $("redo").addEventListener("click", () => decisions.redo());
  for (const role of Object.keys(ROLES)) $(`is-${role}`).addEventListener("click", () => giveRole(role));
  $("distance").addEventListener("input", (e) => goTo(stage.levels.chain.distanceAt(e.target.value / 1000)));
  $("auto").addEventListener("click", keys.a);
  $("leaves").addEventListener("input", (e) => goToSteps(Number(e.target.value)));
  $("make-so").addEventListener("click", makeSo);
  $("layout").addEventListener("change", say);
  $("scope").addEventListener("change", sayPiece);
  $("of-pieces").addEventListener("toggle", listPieces);
  $("pieces").addEventListener("change", chooseListed);
  addEventListener("keydown", onKey);
  if (matchMedia("(prefers-color-scheme: dark)").matches) {
    stage.set({ background: "dark" });
    $("background").value = "dark";
  }
  say();
  const { settings, grown } = askedBy(location.hash);
  state.asked = settings;
  if (grown) open({ grown });
  addEventListener("hashchange", () => {
    const { settings } = askedBy(location.hash);
    if (settings && state.source && !state.isBusy) decisions.decide(settings);
  });
  window.page = { state, stage, decisions, open, make, take, get engine() { return engine; } };
  try {
    await engine.module;
    document.documentElement.dataset.ready = Math.round(performance.now());
  } catch (error) {
    tell(`The engine does not start: ${error.message}`);
  }
};
