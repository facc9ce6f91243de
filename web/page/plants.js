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
