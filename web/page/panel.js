// The panel: what it shows of the plant, of what is asked for, and of the levels.

const $ = (id) => document.getElementById(id);

const element = (name, text = "", properties = {}) => {
  const made = document.createElement(name);
  made.textContent = text;
  return Object.assign(made, properties);
};

const tell = (text) => {
  $("error").hidden = text === "";
  $("error").textContent = text;
  if (text !== "") $("error").scrollIntoView({ block: "nearest" });
};

const press = (button, is) => button.setAttribute("aria-pressed", String(is));

const cssColor = (color) => `rgb(${color.slice(0, 3).map((c) => Math.round(255 * c ** (1 / 2.2))).join(" ")})`;

// The parts of the plant; choose is called with a place.
const fillParts = (inspection, picked, choose) => {
  const rows = inspection.primitives.filter((primitive) => primitive.taken_for !== "nothing").map((primitive) => {
    const role = ROLES[roleOfPrimitive(primitive)];
    const button = element("button", "", { type: "button" });
    const dot = element("i");
    dot.style.background = cssColor(role.color);
    const inPart = primitive.taken_for === "foliage_in_part" ? ", wood in part" : "";
    button.append(dot, element("strong", primitive.material === "#none" ? primitive.mesh : primitive.material));
    button.append(element("span", `${role.name}${inPart} · ${number(primitive.triangles * primitive.placements)} triangles`));
    button.setAttribute("aria-current", String(primitive.place === picked));
    button.addEventListener("click", () => choose(primitive.place));
    const row = element("li");
    row.append(button);
    return row;
  });
  $("parts").replaceChildren(...rows);
};

// What is said of several that were chosen: { items, triangles }.
const chosenText = ({ items, triangles }) => {
  const all = Object.values(items);
  const pieces = all.reduce((sum, numbers) => sum + (numbers?.length ?? 0), 0);
  const counted = (n, name) => `${number(n)} ${name}${n === 1 ? "" : "s"}`;
  const parts = counted(all.length, "part");
  return `You chose ${pieces > 0 ? `${counted(pieces, "piece")} of ${parts}` : parts}, ${counted(triangles, "triangle")} in all. What are they?`;
};

const fillPart = (primitive, met, chosen) => {
  $("part").hidden = !primitive && !chosen;
  $("of-scope").hidden = chosen !== null;
  $("of-pieces").hidden = !(primitive?.pieces > 1);
  if ($("pieces").dataset.of !== primitive?.place) {
    $("of-pieces").open = false;
    $("pieces").dataset.of = "";
    $("pieces").replaceChildren();
  }
  if (chosen) {
    $("why").textContent = chosenText(chosen);
    for (const role of Object.keys(ROLES)) press($(`is-${role}`), false);
  }
  if (!primitive || chosen) return;
  const by = primitive.chosen_by_user ? "You chose it." : "";
  const reasons = primitive.reasons.map((reason) => `${reason.points > 0 ? "+" : ""}${reason.points || "·"} ${reason.text}`);
  const piece = met ? ` You clicked piece ${number(met.number + 1)}, of ${number(met.triangles)} triangles.` : "";
  $("why").textContent = [`Mesh ${primitive.mesh}, ${number(primitive.pieces)} pieces.${piece} ${by}`.trim(), ...reasons].join("\n");
  for (const role of Object.keys(ROLES)) press($(`is-${role}`), roleOfPrimitive(primitive) === role);
};

// Numbers of a text field; null where they are wrong.
const numbersOf = (text, isRight) => {
  const all = text.split(/[\s,;]+/).filter((word) => word !== "").map(Number);
  return all.length > 0 && all.length <= 8 && all.every((n) => Number.isFinite(n) && n > 0) && isRight(all) ? all : null;
};
const rises = (all) => all.every((n, k) => k === 0 || all[k - 1] < n);
const falls = (all) => all.every((n, k) => k === 0 || all[k - 1] > n);

// What is asked for, as controls show it.
const fillTarget = (now, triangles) => {
  for (const button of document.querySelectorAll("[data-kind]")) press(button, button.dataset.kind === now.kind);
  for (const button of document.querySelectorAll("[data-effort]")) press(button, button.dataset.effort === now.effort);
  $("chain").hidden = now.kind !== "chain";
  $("one").hidden = now.kind !== "level";
  $("levels").value = now.levels;
  $("of-distances").hidden = now.levels !== "distances";
  $("of-shares").hidden = now.levels !== "shares";
  $("distances").value = now.distances.join(", ");
  $("shares").value = now.shares.map((share) => Math.round(1e4 * share) / 100).join(", ");
  $("quality").value = String(now.maxDifference);
  $("original").checked = now.original;
  $("impostor").checked = now.impostor;
  $("sways").checked = now.wind;
  $("of-impostor").hidden = now.levels === "shares";
  const { amount, value } = now.level;
  $("amount").value = amount;
  $("of-share").hidden = amount !== "share";
  $("of-triangles").hidden = amount !== "triangles";
  if (amount === "share") {
    $("share").value = Math.round(100 * value);
    $("share-text").textContent = `${Math.round(100 * value)} % · ${number(Math.round(value * triangles))}`;
  } else $("triangles").value = value;
};

// Listens to these controls.
const listenToTarget = (decisions, triangles) => {
  const decide = (change, joins) => decisions.decide(change, joins);
  for (const button of document.querySelectorAll("[data-kind]")) button.addEventListener("click", () => decide({ kind: button.dataset.kind, shown: null }));
  for (const button of document.querySelectorAll("[data-effort]")) button.addEventListener("click", () => decide({ effort: button.dataset.effort, shown: null }));
  const on = (id, of) => $(id).addEventListener("change", (event) => {
    const change = of(event.target);
    if (change !== null) decide({ ...change, shown: null });
    else tell(`${event.target.value || "Nothing"}: ${RIGHT[id]}`);
  });
  on("levels", (e) => ({ levels: e.value }));
  on("quality", (e) => ({ maxDifference: Number(e.value) }));
  on("original", (e) => ({ original: e.checked }));
  on("impostor", (e) => ({ impostor: e.checked }));
  on("sways", (e) => ({ wind: e.checked }));
  on("distances", (e) => {
    const distances = numbersOf(e.value, rises);
    return distances && { distances };
  });
  on("shares", (e) => {
    const shares = numbersOf(e.value, (all) => falls(all) && all[0] <= 100);
    return shares && { shares: shares.map((share) => share / 100) };
  });
  on("amount", (e) => ({ level: e.value === "share" ? { amount: "share", value: 0.25 } : { amount: "triangles", value: Math.max(1, Math.round(triangles() / 4)) } }));
  on("triangles", (e) => {
    const value = Number(e.value);
    return Number.isSafeInteger(value) && value > 0 ? { level: { amount: "triangles", value } } : null;
  });
  $("share").addEventListener("input", (e) => decide({ level: { amount: "share", value: Number(e.target.value) / 100 }, shown: null }, "share"));
};

const RIGHT = {
  distances: "write up to eight distances in metres that rise, such as 5, 20, 80",
  shares: "write up to eight shares in per cent that fall, such as 50, 25, 10",
  triangles: "write a whole number of triangles",
};

// The levels, a button each.
const fillLevels = (result, shown, choose) => {
  const rows = result.levels.map((level, k) => {
    const words = wordsOf(level, result.original, result.kind === "level" ? null : k);
    const button = element("button", "", { type: "button", title: words.more });
    button.append(element("strong", `${words.title} · ${words.cost}`), element("span", words.look));
    button.setAttribute("aria-current", String(k === shown));
    button.addEventListener("click", () => choose(k));
    const row = element("li");
    row.append(button);
    if (k === shown) row.append(element("p", words.more, { className: "soft" }));
    return row;
  });
  $("list").replaceChildren(...rows);
};
