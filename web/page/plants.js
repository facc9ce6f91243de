// The plants that are open: one is shown, and each keeps its decisions and what was made of it.

const isPlant = (file) => /\.(glb|gltf)$/i.test(file.name);

// Files as what is opened: a plant for each .glb, and for each .gltf with the files that it may name, the nearest first.
const sourcesOf = (files) => {
  const others = files.filter((file) => !isPlant(file));
  const sources = files.filter(isPlant).map((plant) => {
    const isNear = (file) => Number((file.folder ?? "").startsWith(plant.folder ?? ""));
    const needed = /\.glb$/i.test(plant.name) ? [] : others.toSorted((a, b) => isNear(b) - isNear(a));
    return { files: [plant, ...needed] };
  });
  return sources.length > 0 ? sources : [{ files }];
};

const plantOf = (source) => ({
  source,
  label: source.grown ? `${source.grown.species}.glb` : `${source.files[0].folder ?? ""}${source.files[0].name}`,
  // Once it was open: its triangles, and its decisions.
  triangles: null,
  kept: null,
  // Of its bytes, where the browser can say it.
  sha256: null,
  // Results by what was asked for, the last ones of this plant.
  results: new Map(),
});

// The list of plants, where there are several.
const fillPlants = (plants, shown, isBusy, choose) => {
  $("of-plants").hidden = plants.length < 2;
  const rows = plants.map((plant) => {
    const button = element("button", "", { type: "button", disabled: isBusy });
    const made = plant.results.size > 0 ? " · made lighter" : "";
    const said = plant.triangles === null ? "not looked at yet" : `${number(plant.triangles)} triangles${made}`;
    button.append(element("strong", plant.label), element("span", said));
    button.setAttribute("aria-current", String(plant === shown));
    button.addEventListener("click", () => plant !== shown && choose(plant));
    const row = element("li");
    row.append(button);
    return row;
  });
  $("plants").replaceChildren(...rows);
  $("close").disabled = isBusy;
};

// Shows a plant instead of the one that is shown, which keeps its decisions and what they gave.
const turnTo = async (plant) => {
  const began = performance.now();
  engine.open = null;
  const openWith = ({ leaves = [], notPlant = [] }) => engine.call("open", { source: plant.source, leaves, notPlant });
  let opened = await openWith(plant.kept?.now ?? {});
  plant.sha256 = opened.sha256;
  const known = { ...recalled(plant.sha256), ...state.asked };
  if (!plant.kept && (known.leaves?.length > 0 || known.notPlant?.length > 0)) opened = await openWith(known);
  leave();
  decisions.begin(plant.kept, known);
  state.asked = null;
  engine.open = decisions.opening;
  Object.assign(state, { plant, source: plant.source, name: opened.name, results: plant.results });
  stage.set({ mode: "plant", picked: null, hasRoles: false, isTrueSize: false });
  shown(opened, true);
  plant.triangles = trianglesOf(state.inspection);
  hideOpen();
  stage.draw();
  state.openedMs = performance.now() - began;
  decided();
};

const leave = () => {
  if (state.plant) state.plant.kept = decisions.kept;
  const shown = decisions.key;
  for (const key of [...state.results.keys()]) if (key !== shown) forget(key);
  stage.levels = null;
};

const forget = (key) => {
  stage.renderer.free(state.results.get(key).taken.model);
  state.results.delete(key);
};

// Opens a plant of each source, and shows the first that can be read.
const openAll = (sources) => busy("Opening", async () => {
  const plants = sources.map(plantOf);
  while (plants.length > 0) {
    try {
      await turnTo(plants[0]);
      state.plants.push(...plants);
      return;
    } catch (error) {
      if (error instanceof Cancelled || plants.length === 1) throw error;
      tell(error.message);
      plants.shift();
    }
  }
});

const open = (source) => openAll([source]);

const choosePlant = (plant) => busy("Opening", () => turnTo(plant));

const closePlant = async () => {
  const { plants, plant } = state;
  const at = plants.indexOf(plant);
  await choosePlant(plants[at + 1] ?? plants[at - 1]);
  if (state.plant === plant) return;
  for (const { taken } of plant.results.values()) stage.renderer.free(taken.model);
  plants.splice(at, 1);
  say();
};
