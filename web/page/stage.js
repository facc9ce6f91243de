// What is drawn: the plant alone, or the plant and a level beside, over or instead of each other.

const BACKGROUNDS = {
  light: [[0.88, 0.905, 0.92], [0.88, 0.905, 0.92]],
  mid: [[0.5, 0.52, 0.53], [0.5, 0.52, 0.53]],
  dark: [[0.09, 0.1, 0.11], [0.09, 0.1, 0.11]],
  sky: [[0.86, 0.9, 0.9], [0.42, 0.62, 0.85]],
};

const PICKED = [1, 0.75, 0.05, 1];

const rawBitmap = (entry, textures) => {
  const [width, height] = entry.texels;
  return new ImageData(new Uint8ClampedArray(textures.buffer, textures.byteOffset + entry.at, entry.length), width, height);
};

class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new Renderer(canvas);
    // mode: "plant", "beside", "wipe", "blink" or "difference". wipe: the share that shows the original.
    // steps: of the removal order, where its slider chooses the leaves of the level; else null.
    // picked: the place of a part; met: { number, triangles, taken } of the
    // piece of it that was clicked; piece: the same, where that piece alone is meant. chosen: { items, triangles, taken }
    // of several that are meant, by place the numbers of pieces, or null for all.
    this.view = { mode: "plant", hasRoles: false, isTrueSize: false, isWindy: false, background: "light", wipe: 0.5, isLevel: true, level: 1, steps: null, distance: 10, picked: null, met: null, piece: null, chosen: null };
    this.plant = null;
    this.levels = null;
    this.heat = null;
    this.orbit = new Orbit(canvas, () => this.ask());
    new ResizeObserver(() => this.ask()).observe(canvas);
  }

  ask() {
    if (this.isAsked || !this.plant) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.draw();
      if (this.wind) this.ask();
    });
  }

  // Whether what is shown says what it hangs on.
  get canSway() {
    const shown = this.isAlone ? this.plant : this.levels;
    return (shown?.model.scene.levels ?? []).some((level) => level.surfaces.some((surface) => surface.holds !== null));
  }

  // The breeze of this moment, or null where none blows.
  get wind() {
    if (!this.view.isWindy || !this.canSway) return null;
    return breeze(this.chain.size[1], performance.now() / 1000);
  }

  // A picture that came from the engine, as { model, chain }.
  taken({ scene, geometry, textures }) {
    const model = modelOf(scene, geometry.buffer, scene.textures.map((entry) => rawBitmap(entry, textures)));
    return { model, chain: new Chain(scene), parts: scene.parts };
  }

  showPlant(picture) {
    if (this.plant) this.renderer.free(this.plant.model);
    this.plant = this.taken(picture);
    this.levels = null;
    this.renderer.use(this.plant.model);
    this.plant.profile = profileOf(this.renderer.level(0), this.plant.chain.center);
    this.ask();
  }

  // null: there are no levels any more. What is shown may be shown again later, so nothing is given back.
  showLevels(taken) {
    this.levels = taken;
    this.ask();
  }

  // The removal order of what is shown, or null where there is none.
  get order() {
    if (!this.levels) return null;
    this.renderer.use(this.levels.model);
    return this.renderer.order;
  }

  set(change) {
    Object.assign(this.view, change);
    this.ask();
  }

  get chain() {
    return this.isAlone ? this.plant.chain : this.levels.chain;
  }

  // Whether the plant alone is shown, with the roles of its parts.
  get isAlone() {
    return this.view.mode === "plant" || !this.levels;
  }

  boxes() {
    const all = { x: 0, y: 0, width: this.canvas.width, height: this.canvas.height };
    if (this.isAlone || this.view.mode !== "beside") return [all];
    if (all.height > all.width) {
      const half = all.height >> 1;
      return [{ ...all, y: all.height - half, height: half }, { ...all, height: all.height - half }];
    }
    const half = all.width >> 1;
    return [{ ...all, width: half }, { ...all, x: half, width: all.width - half }];
  }

  cameraOf(box) {
    const { view, orbit, chain } = this;
    if (!view.isTrueSize) return filled(chain, this.plant.profile, orbit, box.width / box.height);
    // A page's pixel is one of the screen that levels are for.
    return chain.trueSize(orbit, view.distance, box.height / (window.devicePixelRatio || 1));
  }

  draw() {
    const { canvas, renderer, view } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    renderer.background = BACKGROUNDS[view.background].map((color) => color);
    if (view.background !== "sky") renderer.background[1] = renderer.background[0];
    const boxes = this.boxes();
    const wind = this.wind;
    const picture = (k, box) => renderer.draw({ level: k, steps: k === 0 ? null : view.steps }, this.cameraOf(box), box, { leaves: true, wood: true, wire: false }, wind);
    if (this.isAlone) return this.drawAlone(boxes[0]);
    renderer.use(this.levels.model);
    if (view.mode === "beside") boxes.forEach((box, k) => picture(k === 0 ? 0 : view.level, box));
    else if (view.mode === "blink") picture(view.isLevel ? view.level : 0, boxes[0]);
    else if (view.mode === "difference") {
      this.heat ??= new HeatMap(renderer);
      this.heat.draw(width, height, [0, view.level].map((k) => () => picture(k, boxes[0])));
    } else {
      const at = Math.round(view.wipe * width);
      picture(0, { ...boxes[0], part: { ...boxes[0], width: at } });
      picture(view.level, { ...boxes[0], part: { ...boxes[0], x: at, width: width - at } });
    }
  }

  drawAlone(box) {
    const { renderer, plant, view } = this;
    renderer.use(plant.model);
    const camera = this.cameraOf(box);
    const over = view.chosen ?? (view.picked === null ? null : view.piece);
    // What is chosen is drawn over the plant as it stands.
    const wind = over ? null : this.wind;
    const plants = plant.model.scene.levels[0].surfaces.length;
    plant.model.scene.levels.forEach((_, level) => {
      const meshes = renderer.level(level);
      const partOf = (mesh) => plant.parts[meshes.indexOf(mesh) + level * plants];
      const tint = (mesh) => {
        const part = partOf(mesh);
        if (part.place === view.picked && !over) return PICKED;
        return view.hasRoles ? ROLES[part.role].color : null;
      };
      const isOver = level > 0;
      renderer.draw({ level, steps: null }, camera, { ...box, isOver }, { leaves: true, wood: true, wire: false, tint }, wind);
    });
    if (!over) return;
    const { gl } = renderer;
    renderer.use(over.taken.model);
    // Its corners are rounded to other steps than those of the plant.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-2, -64);
    renderer.draw({ level: 0, steps: null }, camera, { ...box, isOver: true }, { leaves: true, wood: true, wire: false, tint: () => PICKED });
  }

  // The camera of the plant alone, and the box that it fills.
  aloneCamera() {
    const [box] = this.boxes();
    return { camera: this.cameraOf(box), box };
  }

  // Rays from the eye through the pixel at a place of the window, then through those beside it, as { from, along }: what
  // is drawn in a pixel may be thinner than it.
  raysAt(x, y) {
    const [box] = this.boxes();
    const { eye, target, tangent } = this.cameraOf(box);
    const back = unit(add(eye, times(target, -1)));
    const right = unit(cross([0, 1, 0], back));
    const up = cross(back, right);
    const [column, row] = this.pixelAt(x, y);
    const through = ([dx, dy]) => {
      const across = ((2 * (column + dx + 0.5)) / box.width - 1) * tangent * (box.width / box.height);
      const above = ((2 * (row + dy + 0.5)) / box.height - 1) * tangent;
      return { from: eye, along: add(add(times(right, across), times(up, above)), times(back, -1)) };
    };
    const beside = [0, -0.5, 0.5, -1, 1];
    return beside.flatMap((dy) => beside.map((dx) => [dx, dy])).sort((a, b) => Math.hypot(...a) - Math.hypot(...b)).map(through);
  }

  // The pixel at a place of the window, from the lower left of the canvas.
  pixelAt(x, y) {
    const { left, bottom } = this.canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    return [(x - left) * ratio, (bottom - y) * ratio].map(Math.round);
  }

  // The part of the plant at a place of the window, or null.
  partAt(x, y) {
    if (!this.isAlone || !this.plant) return null;
    const [box] = this.boxes();
    const { renderer, plant } = this;
    renderer.use(plant.model);
    const at = this.pixelAt(x, y);
    const plants = plant.model.scene.levels[0].surfaces.length;
    // What is not the plant lies under or around it: it is asked for last.
    for (const [level] of plant.model.scene.levels.entries()) {
      const surface = renderer.surfaceAt(level, this.cameraOf(box), box, ...at);
      if (surface !== null) return plant.parts[surface + level * plants];
    }
    return null;
  }
}
