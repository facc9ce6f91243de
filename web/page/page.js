// The page: what happens when.

const state = {
  // All that is open, as plantOf() has it, and the one that is shown: where it came from, and its inspection.
  plants: [],
  plant: null,
  source: null,
  name: "",
  inspection: null,
  leafPieces: {},
  otherPieces: {},
  problem: null,
  // How the plant was opened that the inspection is of, as decisions have it.
  opening: null,
  // Settings of the link that the page was opened with, until a plant has them.
  asked: null,
  // Those of the plant.
  results: new Map(),
  // The first answer to what is being made: a result that is shown until there is a better one, and its key.
  coarse: null,
  isBusy: false,
};
const MOST_RESULTS = 12;
// Of fewer triangles what is asked for comes in a moment by itself.
const LEAST_COARSE = 2000;

const stage = new Stage($("canvas"));
const decisions = new Decisions(() => decided());
const lasso = new Lasso($("loop"), $("canvas"), chooseInLoop);
let engine = null;

const resultOf = () => state.results.get(decisions.key) ?? (state.coarse?.key === decisions.key ? state.coarse : null);
const trianglesOf = (inspection) => inspection.primitives.reduce((sum, p) => (p.taken_for === "not_plant" ? sum : sum + p.triangles * p.placements), 0);

// Shares of the bar, by the stage that a run is in; steps fill what is between.
const STAGES = { open: "Opening", resolution: "Looking at the plant", simplify: "Choosing leaves", areas: "Looking at the level", fit: "Fitting sizes", audit: "Checking", impostor: "Painting pictures", finish: "Finishing levels" };

const busy = async (text, work, isShown = true) => {
  state.isBusy = true;
  $("bar").removeAttribute("value");
  $("doing").textContent = text;
  $("busy").hidden = !isShown;
  tell("");
  say();
  let isChain = false;
  try {
    return await work((progress) => {
      // Of a chain the bar shows the levels that are done, of one level its steps.
      if (progress.stage === "level") isChain = true;
      if (STAGES[progress.stage]) $("doing").textContent = STAGES[progress.stage];
      if (progress.stage === "level" || (!isChain && progress.share !== null)) $("bar").value = progress.share;
      else if (!isChain) $("bar").removeAttribute("value");
    });
  } catch (error) {
    if (!(error instanceof Cancelled)) tell(error.message);
    return null;
  } finally {
    state.isBusy = false;
    $("busy").hidden = true;
    say();
  }
};

// Opens the plant again where the engine has it not, or with other leaves.
const reopen = async () => {
  const wanted = decisions.opening;
  if (engine.open === wanted) return null;
  const opened = await engine.call("open", { source: state.source, ...JSON.parse(wanted) });
  engine.open = wanted;
  return opened;
};

const shown = (opened, isNew) => {
  state.opening = decisions.opening;
  const { inspection, problem, picture, leafPieces, otherPieces } = opened;
  const parts = picture.scene.parts.map((part) => ({ ...part, role: roleOf(part, inspection) }));
  picture.scene.parts = parts;
  Object.assign(state, { inspection, problem, leafPieces, otherPieces });
  choosePiece(null);
  choose(null);
  stage.showPlant(picture);
  if (isNew) stage.orbit.reset();
};

// A decision was made, or taken back: what it changes is changed.
const decided = () => {
  if (!state.source) return say();
  keep();
  if (state.opening !== decisions.opening && !state.isBusy) {
    busy("Opening", async () => {
      engine.open = null;
      shown(await reopen(), false);
      look();
    });
    return;
  }
  look();
  say();
};

// Shows the result of what is asked for, where there is one.
const look = () => {
  const result = resultOf();
  if ((stage.levels ?? null) === (result?.taken ?? null)) return follow();
  stage.showLevels(result?.taken ?? null);
  if (result && stage.view.mode === "plant") stage.set({ mode: "beside" });
  if (!result) stage.set({ mode: "plant" });
  else if (decisions.now.shown === null) stage.set({ distance: firstDistance(result.taken.chain) });
  follow();
};

// Where the first lighter level begins to be seen.
const firstDistance = (chain) => {
  const lighter = chain.facts.find((facts) => facts.distance > 0 && facts.kind !== "original");
  return lighter ? lighter.distance : chain.distance(540);
};

// The level in the picture: the one that was chosen, or what an engine shows at the distance.
const follow = () => {
  if (!stage.levels) return;
  const wanted = decisions.now.shown ?? levelAt(stage.view.distance);
  stage.set({ steps: null, level: pictureOf(Math.min(wanted, resultOf().levels.length - 1)) });
};

// Numbers of levels in the list, and in the picture, whose first is the original always.
const isOriginalFirst = () => resultOf()?.levels[0].kind === "original";
const pictureOf = (level) => (isOriginalFirst() ? level : level + 1);
const levelAt = (distance) => {
  const { levels } = resultOf();
  return Math.max(levels.findLastIndex((level) => level.distance <= distance * 1.000001), 0);
};
const shownLevel = () => (isOriginalFirst() ? stage.view.level : stage.view.level - 1);

// What the engine made, as it is shown.
const resultFrom = ({ report, picture }, kind, began) => {
  const taken = stage.taken(picture);
  const levels = kind === "level" ? [report.level] : report.levels;
  const notes = [...(report.notes ?? []), ...(report.warnings ?? [])];
  return { kind, taken, levels, original: taken.chain.facts[0], notes, ms: performance.now() - began };
};

// A level that is made fast, and shown while what is asked for is being made; none where that is as fast.
const makeCoarse = async (began, progress) => {
  const { kind, level, effort } = decisions.now;
  const isFast = kind === "level" && effort === "fast";
  if (isFast || trianglesOf(state.inspection) < LEAST_COARSE) return;
  const { key } = decisions;
  const share = kind === "level" ? level : FIRST.level;
  try {
    const made = await engine.call("coarse", { settings: { ...share, effort: "fast", judged: false } }, progress);
    made.report.level.difference = null;
    state.coarse = { ...resultFrom(made, "level", began), key };
    look();
    say();
  } catch (error) {
    if (error instanceof Cancelled) throw error;
    // What is asked for will say what is wrong.
    await reopen();
  }
};

const dropCoarse = () => {
  if (!state.coarse) return;
  const { taken } = state.coarse;
  state.coarse = null;
  look();
  stage.renderer.free(taken.model);
};

const make = () => busy("Getting ready", async (progress) => {
  const { kind } = decisions.now;
  const { key, settings } = decisions;
  await reopen();
  const began = performance.now();
  try {
    if (!state.results.has(key)) await makeCoarse(began, progress);
    const made = await engine.call("make", { key, kind, settings }, progress);
    state.results.set(key, resultFrom(made, kind, began));
  } finally {
    dropCoarse();
  }
  if (state.results.size > MOST_RESULTS) forget(state.results.keys().next().value);
  look();
});

const save = (name, bytes, type = "model/gltf-binary") => {
  const link = element("a");
  link.href = URL.createObjectURL(new Blob([bytes], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};

// Bytes that the engine made; made again where it has forgotten them.
const take = async (given) => {
  const { key, settings } = decisions;
  const { kind } = decisions.now;
  await reopen();
  return busy("Writing", async (progress) => {
    await engine.call("make", { key, kind, settings }, progress);
    return engine.call("take", { key, ...given });
  });
};

const stem = () => state.name.replace(/\.[^.]*$/, "");

const homeButtons = (result) => {
  const button = (text, act, isMain = false) => {
    const made = element("button", text, { type: "button", className: isMain ? "main" : "", disabled: state.isBusy });
    made.addEventListener("click", act);
    return made;
  };
  const layout = $("layout").value;
  if (result.kind === "level") {
    return [button("Save the level (.glb)", async () => {
      const bytes = await take({ what: "level" });
      if (bytes) save(`${stem()}_lighter.glb`, bytes);
    }, true)];
  }
  const level = shownLevel();
  const all = button("Save all (.zip)", async () => {
    const bytes = await take({ what: "zip", layout });
    if (bytes) save(`${stem()}_levels.zip`, bytes, "application/zip");
  }, true);
  const one = button(layout === "files" ? `Save ${wordsOf(result.levels[level], result.original, level).title.toLowerCase()} (.glb)` : "Save the file (.glb)", async () => {
    const bytes = await take({ what: "file", layout, number: layout === "files" ? level : 0 });
    if (bytes) save(layout === "files" ? `${stem()}_LOD${level}.glb` : `${stem()}_lods.glb`, bytes);
  });
  const page = button("Save the page to look at them", async () => {
    const bytes = await take({ what: "preview" });
    if (bytes) save(`${stem()}_preview.html`, bytes, "text/html");
  });
  return [all, one, page];
};

// Writes everything that is shown in words.
const say = () => {
  const { now } = decisions;
  const { inspection } = state;
  const result = resultOf();
  const isOpen = state.source !== null;
  $("undo").disabled = decisions.past.length === 0 || state.isBusy;
  $("redo").disabled = decisions.future.length === 0 || state.isBusy;
  $("again").hidden = !isOpen;
  for (const id of ["of-plant", "of-target", "tools"]) $(id).hidden = !isOpen;
  $("of-levels").hidden = !result;
  $("of-home").hidden = !result || result === state.coarse;
  document.body.classList.toggle("empty", !isOpen);
  if (!isOpen) return;
  $("name").textContent = state.name;
  fillPlants(state.plants, state.plant, state.isBusy, choosePlant);
  document.title = `${state.name} – secateur`;
  sayPlant(inspection);
  fillTarget(now, trianglesOf(inspection));
  $("make").disabled = state.isBusy || state.problem !== null;
  $("make").textContent = result && result !== state.coarse ? "Made" : "Make it lighter";
  if (result) $("make").disabled = true;
  sayView(result);
  if (result) sayLevels(result);
};

const sayPlant = (inspection) => {
  const { foliage } = inspection;
  const triangles = trianglesOf(inspection);
  $("counts").textContent = foliage
    ? `${number(triangles)} triangles: ${number(foliage.leaves)} leaves of ${number(foliage.triangles)}, ${number(inspection.wood_triangles)} of wood`
    : `${number(triangles)} triangles`;
  const said = [state.problem, ...inspection.notes, ...inspection.warnings].filter((text) => text);
  $("problem").hidden = said.length === 0;
  $("problem").textContent = said.join(" ").replaceAll("use `--foliage`", "choose them here");
  const { picked, met, chosen } = stage.view;
  fillParts(inspection, picked, pick);
  fillPart(inspection.primitives.find((primitive) => primitive.place === picked), met, chosen);
};

const sayView = (result) => {
  const { view } = stage;
  const mode = result ? view.mode : "plant";
  for (const button of document.querySelectorAll("[data-mode]")) {
    press(button, button.dataset.mode === mode);
    button.disabled = !result && button.dataset.mode !== "plant";
  }
  press($("roles"), view.hasRoles);
  sayLasso();
  $("roles").disabled = mode !== "plant";
  press($("true-size"), view.isTrueSize);
  press($("wind"), view.isWindy);
  $("wind").hidden = !stage.canSway;
  $("wipe").hidden = mode !== "wipe";
  $("seam").hidden = mode !== "wipe";
  $("seam").style.left = `${100 * view.wipe}%`;
  const [first, second] = $("captions").children;
  const original = `${state.name} · ${number(trianglesOf(state.inspection))} triangles`;
  const level = () => {
    const left = shownLeaves();
    if (left) return `${number(left.leaves)} leaves · ${number(left.triangles)} triangles · ${percentOf(left.triangles, result.original.triangles)}`;
    const k = shownLevel();
    const words = wordsOf(result.levels[k], result.original, result.kind === "level" ? null : k);
    return `${words.title} · ${words.cost}`;
  };
  second.hidden = mode === "plant" || mode === "blink";
  $("legend").hidden = mode !== "difference";
  first.textContent = mode === "blink" && view.isLevel ? level() : original;
  if (!second.hidden) second.textContent = level();
};

const sayLevels = (result) => {
  const { chain } = result.taken;
  const { view } = stage;
  const high = chain.pixelsHigh(view.distance);
  $("distance").value = Math.round(1000 * chain.share(view.distance));
  $("distance-text").textContent = `${metresOf(view.distance)} · ${Math.round(high)} px`;
  $("distance").setAttribute("aria-valuetext", $("distance-text").textContent);
  press($("auto"), decisions.now.shown === null && view.steps === null);
  sayLeaves();
  $("fades").hidden = !(view.isTrueSize && high < 200);
  fillLevels(result, view.steps === null ? shownLevel() : null, chooseLevel);
  const isCoarse = result === state.coarse;
  const notes = isCoarse ? ["A first answer, made fast. What you asked for takes its place when it is done."] : result.notes;
  $("notes").replaceChildren(...notes.map((note) => element("li", note)));
  if (isCoarse) return;
  $("home").replaceChildren(...homeButtons(result));
  $("of-layout").hidden = result.kind === "level";
  const { grown } = state.source;
  const grows = grown ? `secateur grow ${grown.species} --leaves ${grown.leaves} --seed ${grown.seed} -o ${state.name}\n` : "";
  $("command").textContent = grows + commandOf(decisions, state.name, $("layout").value);
};

const showOpen = () => {
  $("open").hidden = false;
  $("back").hidden = state.source === null;
};
const hideOpen = () => {
  $("open").hidden = true;
};

start();
