// The page: what is shown, and what the controls do.

const $ = (id) => document.getElementById(id);
const count = (n) => n.toLocaleString("en-US");
const metres = (d) => `${d < 10 ? d.toFixed(1) : Math.round(d)} m`;
const share = (part, whole) => {
  const percent = (100 * part) / whole;
  return `${percent < 10 ? percent.toFixed(1) : Math.round(percent)} %`;
};

const scene = JSON.parse($("scene").textContent);
const chain = new Chain(scene);
const canvas = $("canvas");
const levels = chain.facts.length;

const state = {
  distance: 0,
  level: 0,
  // Of the way to the next level.
  share: 0,
  isAutomatic: true,
  // Of the removal order, where its slider chooses the leaves; else null.
  steps: null,
  show: { leaves: true, wood: true, wire: false },
  isTrueSize: false,
  isSpinning: false,
  // The wind, and for how long it has blown.
  isWindy: false,
  windSeconds: 0,
  isWalking: false,
  // Of the walk: away from the tree, or back.
  isGoingAway: true,
};

let renderer = null;
let isAsked = false;
const ask = () => {
  if (isAsked || !renderer) return;
  isAsked = true;
  requestAnimationFrame(frame);
};
const orbit = new Orbit(canvas, ask);

// The share of a half that the picture at true size takes.
const TRUE_SIZE_SHARE = 0.36;

// Cuts a box in two along its longer side.
const cut = (box, share) => {
  if (box.height >= box.width) {
    const height = Math.round(box.height * (1 - share));
    return [{ ...box, height }, { ...box, y: box.y + height, height: box.height - height }];
  }
  const width = Math.round(box.width * (1 - share));
  return [{ ...box, width }, { ...box, x: box.x + width, width: box.width - width }];
};

// The height that an element takes with its margins, in pixels of the canvas.
const heightOf = (element) => {
  const { marginTop, marginBottom } = getComputedStyle(element);
  return Math.ceil((element.offsetHeight + parseFloat(marginTop) + parseFloat(marginBottom)) * ratio());
};

// Cuts this many pixels off the top of a box, or off its bottom.
const below = (box, px) => ({ ...box, y: box.y + px, height: Math.max(box.height - px, 1) });
const above = (box, px) => ({ ...box, height: Math.max(box.height - px, 1) });

const SIDES = ["original", "level"];

// Lays the labels of the original and the level over the halves of the canvas, for trees this many pixels high on the
// screen, and gives the boxes of their pictures, in pixels of the canvas from the upper left: a large one, and one at true
// size unless the large one is. Labels stand above the one and, as far as the tree leaves room, below the other.
const layOut = (high) => {
  const halves = cut({ x: 0, y: 0, width: canvas.width, height: canvas.height }, 0.5);
  const parts = halves.map((half) => (state.isTrueSize ? [half, half] : cut(half, TRUE_SIZE_SHARE)));
  parts.forEach(([named, sized], k) => {
    lay($(`half-${SIDES[k]}`), named);
    lay($(`inset-${SIDES[k]}`), sized);
    $(`inset-${SIDES[k]}`).firstElementChild.textContent = `True size · ${Math.round(high)} px`;
  });
  // How high they are is known once they are as wide as they will be.
  const head = Math.max(...SIDES.map((side) => heightOf($(`name-${side}`))));
  const foot = heightOf($("inset-level").firstElementChild);
  const aboveFoot = (box) => above(box, clamp(box.height - high * ratio(), 0, foot));
  return parts.map(([named, sized]) => {
    const large = below(named, head);
    return state.isTrueSize ? { large: aboveFoot(large), small: null } : { large, small: aboveFoot(sized) };
  });
};

const ratio = () => window.devicePixelRatio || 1;

const fit = () => {
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio()));
  const height = Math.max(1, Math.round(canvas.clientHeight * ratio()));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
};

const picture = (level, camera, box, show, windSeconds = null) => {
  const wind = windSeconds === null ? null : breeze(chain.size[1], windSeconds);
  renderer.draw(level, camera, { ...box, y: canvas.height - box.y - box.height }, show, wind);
};

const draw = () => {
  fit();
  const plain = { ...state.show, wire: false };
  const high = chain.pixelsHigh(state.distance);
  const wind = state.isWindy ? state.windSeconds : null;
  renderer.clear({ x: 0, y: 0, width: canvas.width, height: canvas.height });
  layOut(high).forEach(({ large, small }, k) => {
    const level = k === 0 ? { level: 0, steps: null } : { level: state.level, steps: state.steps, share: state.share };
    const trueSize = (box) => chain.trueSize(orbit, state.distance, box.height);
    const camera = state.isTrueSize ? trueSize(large) : chain.closeUp(orbit, large.width / large.height);
    picture(level, camera, large, state.show, wind);
    if (small) picture(level, trueSize(small), small, plain, wind);
  });
};

// Puts an element over a box.
const lay = (element, box) => {
  const px = (x) => `${x / ratio()}px`;
  Object.assign(element.style, { left: px(box.x), top: px(box.y), width: px(box.width), height: px(box.height) });
};

// Frames per second over the last half second of steady drawing.
const pace = { since: 0, frames: 0, last: 0, isSteady: false };
const frame = (now) => {
  isAsked = false;
  // However slow frames are, those that the page itself asks for follow each other.
  if (!pace.isSteady && now - pace.last > 250) Object.assign(pace, { since: now, frames: 0 });
  else pace.frames += 1;
  if (now - pace.since > 500) {
    const rate = (1000 * pace.frames) / (now - pace.since);
    $("fps").textContent = `${rate < 10 ? rate.toFixed(1) : Math.round(rate)} fps`;
    Object.assign(pace, { since: now, frames: 0 });
  }
  pace.isSteady = state.isSpinning || state.isWalking || state.isWindy;
  const step = Math.min(now - pace.last, 100);
  pace.last = now;
  if (state.isSpinning) orbit.turn(0.0006 * step, 0);
  if (state.isWalking) walk(step);
  if (state.isWindy) state.windSeconds += step / 1000;
  draw();
  if (pace.isSteady) ask();
};

const say = () => {
  const original = chain.facts[0];
  const facts = shownFacts();
  const parts = (f) => {
    if (f.kind === "impostor") return "pictures on cards";
    const leaves = f.leaves === null ? "leaves" : `${count(f.leaves)} leaves`;
    return `${count(f.foliage_triangles)} in ${leaves} · ${count(f.wood_triangles)} in wood`;
  };
  const name = (id, title, f, of) => {
    const head = document.createElement("strong");
    head.textContent = title;
    const lines = [`${count(f.triangles)} triangles${of}`, parts(f)].map((text) => {
      const line = document.createElement("span");
      line.textContent = text;
      return line;
    });
    $(id).replaceChildren(head, ...lines);
  };
  name("name-original", "Original", original, "");
  name("name-level", facts.name, facts, facts !== original ? ` · ${share(facts.triangles, original.triangles)}` : "");
  $("distance").value = Math.round(1000 * chain.share(state.distance));
  $("distance-text").textContent = `${metres(state.distance)} · ${Math.round(chain.pixelsHigh(state.distance))} px`;
  $("distance").setAttribute("aria-valuetext", $("distance-text").textContent);
  $("level").value = state.level;
  $("level").setAttribute("aria-valuetext", facts.name);
  $("level-text").textContent = facts.name;
  sayLeaves();
  const pop = facts.pop === null ? "" : facts.pop.toFixed(2).replace(/^0/, "");
  $("switch").textContent = pop && `The switch to ${facts.name} shows a difference of ${pop}.`;
  const pressed = {
    auto: state.isAutomatic,
    leaves: state.show.leaves,
    wood: state.show.wood,
    wire: state.show.wire,
    "true-size": state.isTrueSize,
    spin: state.isSpinning,
    wind: state.isWindy,
    walk: state.isWalking,
  };
  for (const [id, is] of Object.entries(pressed)) $(id).setAttribute("aria-pressed", is);
  document.querySelectorAll("#levels tr").forEach((row, k) => row.classList.toggle("current", k === state.level));
  document.querySelectorAll("#bands span").forEach((band, k) => band.classList.toggle("current", k === state.level));
  ask();
};

// The facts of what is shown on the right.
const shownFacts = () => {
  const level = chain.facts[state.level];
  if (state.steps === null) return level;
  const { leaves, triangles } = renderer.order;
  const foliage_triangles = triangles[state.steps];
  const total = { triangles: foliage_triangles + level.wood_triangles, pop: null };
  return { ...level, name: `${count(leaves[state.steps])} leaves`, leaves: leaves[state.steps], foliage_triangles, ...total };
};

const sayLeaves = () => {
  if (!renderer?.order) return;
  const { leaves } = renderer.order;
  // Where a level is shown the slider stands where it has as many leaves.
  const steps = state.steps ?? renderer.order.stepsTo(chain.facts[state.level].leaves ?? leaves[0]);
  $("steps").value = steps;
  $("steps-text").textContent = count(leaves[steps]);
  $("steps").setAttribute("aria-valuetext", `${count(leaves[steps])} leaves`);
};

// Shows the level after this number of steps of the removal order, with the wood of the coarsest level of
// at least as many leaves.
const goToSteps = (steps) => {
  if (!renderer?.order) return;
  state.steps = clamp(Math.round(steps), 0, renderer.order.steps);
  state.share = 0;
  const leaves = renderer.order.leaves[state.steps];
  state.level = Math.max(chain.facts.findLastIndex((f) => f.leaves !== null && f.leaves >= leaves), 0);
  state.isAutomatic = false;
  state.isWalking = false;
  say();
};

const goTo = (distance) => {
  state.steps = null;
  state.distance = clamp(distance, chain.nearest, chain.farthest);
  state.isAutomatic = true;
  Object.assign(state, chain.shownAt(state.distance));
  say();
};
const choose = (level) => {
  state.steps = null;
  state.level = clamp(level, 0, levels - 1);
  state.share = 0;
  state.isAutomatic = false;
  state.isWalking = false;
  say();
};
// What moves a slider.
const SLIDER_KEYS = new Set(["Home", "End", "PageUp", "PageDown", "ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"]);
// A walk takes as long for each doubling of the distance: what is seen shrinks evenly.
const WALK_MS = 12000;
const walk = (step) => {
  const share = chain.share(state.distance) + ((state.isGoingAway ? 1 : -1) * step) / WALK_MS;
  if (share >= 1) state.isGoingAway = false;
  if (share <= 0) state.isGoingAway = true;
  goTo(chain.distanceAt(clamp(share, 0, 1)));
};
// Automatic again.
const follow = () => {
  state.isAutomatic = !state.isAutomatic;
  if (state.isAutomatic) Object.assign(state, { steps: null, ...chain.shownAt(state.distance) });
  say();
};
const flip = (of, key) => () => {
  of[key] = !of[key];
  say();
};

const actions = {
  auto: follow,
  leaves: flip(state.show, "leaves"),
  wood: flip(state.show, "wood"),
  wire: flip(state.show, "wire"),
  "true-size": flip(state, "isTrueSize"),
  spin: flip(state, "isSpinning"),
  wind: () => {
    if (renderer?.canSway) flip(state, "isWindy")();
  },
  walk: flip(state, "isWalking"),
  reset: () => orbit.reset(),
};
const keys = { a: "auto", l: "leaves", w: "wood", f: "wire", t: "true-size", s: "spin", b: "wind", r: "reset", g: "walk" };

const fillTable = () => {
  const isKnown = (key) => chain.facts.some((f) => f[key] !== null);
  for (const head of document.querySelectorAll("th[data-of]")) if (!isKnown(head.dataset.of)) head.remove();
  const row = (f, k) => {
    const row = document.createElement("tr");
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = f.name;
    button.addEventListener("click", () => choose(k));
    const bar = document.createElement("i");
    bar.style.width = `${(100 * f.triangles) / chain.facts[0].triangles}%`;
    const texts = [
      count(f.triangles),
      f.distance > 0 ? metres(f.distance) : "–",
      ...[
        ["pixels_high", (x) => `${Math.round(x)} px`],
        ["difference", (x) => x.toFixed(2).replace(/^0/, "")],
        ["silhouette_iou", (x) => `${(100 * x).toFixed(1)} %`],
      ].filter(([key]) => isKnown(key)).map(([key, text]) => f[key] === null ? "–" : text(f[key])),
    ];
    const cells = texts.map((text) => {
      const cell = document.createElement("td");
      cell.textContent = text;
      return cell;
    });
    cells[0].append(bar);
    const head = document.createElement("th");
    head.scope = "row";
    head.append(button);
    row.append(head, ...cells);
    return row;
  };
  $("levels").replaceChildren(...chain.facts.map(row));
  const starts = chain.facts.map((f, k) => k === 0 ? 0 : chain.share(Math.max(f.distance, chain.nearest)));
  const bands = starts.map((start, k) => {
    const band = document.createElement("span");
    band.style.flexGrow = Math.max((starts[k + 1] ?? 1) - start, 0);
    band.textContent = chain.facts[k].name.replace(/^LOD/, "");
    return band;
  });
  $("bands").replaceChildren(...bands);
  const degrees = scene.screen[1];
  $("screen").textContent = `For a screen ${count(chain.screenHeight)} pixels high, ${degrees}° field of view. The tree is ${metres(chain.size[1])} high.`;
};

const listen = () => {
  $("level").max = levels - 1;
  $("distance").addEventListener("input", (e) => {
    state.isWalking = false;
    goTo(chain.distanceAt(e.target.value / 1000));
  });
  $("level").addEventListener("input", (e) => choose(Number(e.target.value)));
  $("steps").addEventListener("input", (e) => goToSteps(Number(e.target.value)));
  // Of the two sliders the one that does not choose what is shown stands where it would have to: asked to go
  // there it makes no input, though it is to choose from then on.
  const takeOver = (id, chooses, act) => {
    const look = (e) => {
      if (!chooses() && (e.type === "click" || SLIDER_KEYS.has(e.key))) act(Number(e.target.value));
    };
    for (const end of ["keyup", "click"]) $(id).addEventListener(end, look);
  };
  takeOver("level", () => state.steps === null, choose);
  takeOver("steps", () => state.steps !== null, goToSteps);
  for (const [id, act] of Object.entries(actions)) $(id).addEventListener("click", act);
  addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const key = e.key.toLowerCase();
    if (/^[0-8]$/.test(key)) choose(Number(key));
    else if (key === "[") goTo(state.distance / 1.06);
    else if (key === "]") goTo(state.distance * 1.06);
    else if (key === "," || key === ".") goToSteps(Number($("steps").value) + (key === "," ? -1 : 1) * Math.max(1, $("steps").max / 100));
    else if (keys[key]) actions[keys[key]]();
  });
  new ResizeObserver(ask).observe(canvas);
  canvas.addEventListener("webglcontextlost", () => {
    renderer = null;
    tell("The browser took the graphics card away. Load the page again.");
  });
};

const tell = (text) => {
  $("message").hidden = text === "";
  $("message").textContent = text;
};

// A picture of one level alone, as PNG, or of the removal order after some steps with that level's
// wood: for who compares renderers. The camera is { eye, target, tangent (of half the field of view),
// near, far }; the wind has blown for some seconds, or blows not at all; the level has gone a share of the way to
// the next.
const pictureOf = (level, camera, width, height, steps = null, windSeconds = null, share = 0) => {
  Object.assign(canvas, { width, height });
  const show = { leaves: true, wood: true, wire: false };
  picture({ level, steps, share }, camera, { x: 0, y: 0, width, height }, show, windSeconds);
  const url = canvas.toDataURL("image/png");
  draw();
  return url;
};

// What was not needed for the first picture, while nothing else is to be done.
const unpackRest = async () => {
  const idle = () => new Promise((done) => (window.requestIdleCallback ?? setTimeout)(done));
  for (let level = 0; level < levels; level++) {
    await idle();
    renderer?.level(level);
  }
  await idle();
  sayLeaves();
};

const start = async () => {
  fillTable();
  listen();
  // Where a level begins, a difference shows most: the first level that the
  // picture at true size shows whole, or the last one.
  const fits = (f) => f.distance > 0 && chain.pixelsHigh(f.distance) < 300;
  const first = chain.facts.find(fits) ?? chain.facts.at(-1);
  goTo(first.distance > 0 ? first.distance : chain.distance(270));
  try {
    const made = new Renderer(canvas);
    await made.load(scene, bytesOf("geometry"), bytesOf("pictures"));
    renderer = made;
    $("any-number").hidden = !scene.continuous;
    if (scene.continuous) $("steps").max = scene.continuous.steps;
    $("wind").hidden = !renderer.canSway;
    draw();
    tell("");
    window.preview = { state, orbit, chain, get order() { return renderer.order; }, light: { ...LIGHT, background: BACKGROUND }, draw, pictureOf };
    document.documentElement.dataset.ready = Math.round(performance.now());
    unpackRest();
  } catch (error) {
    tell(error.message);
  }
};
start();
