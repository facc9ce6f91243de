// Which level an engine shows at which distance, and how high the screen shows it.

class Chain {
  constructor(scene) {
    const [screenHeight, degrees] = scene.screen;
    const size = scene.high.map((x, k) => Math.max(x - scene.low[k], 1e-9));
    // Null is what is not known of a level, and what the original would say of itself.
    this.facts = scene.levels.map(({ facts, surfaces }) => ({
      ...facts,
      leaves: facts.leaves || null,
      morphs: surfaces.some((surface) => surface.ends !== undefined),
      ...(facts.kind === "original" && { difference: null, silhouette_iou: null }),
    }));
    this.screenHeight = screenHeight;
    this.tangent = Math.tan((degrees * Math.PI) / 360);
    this.size = size;
    this.center = scene.low.map((x, k) => x + size[k] / 2);
    this.radius = Math.hypot(...size) / 2;
    this.reach = Math.max(scene.reach, 1e-9);
    const distances = this.facts.map((f) => f.distance).filter((d) => d > 0);
    const full = this.distance(screenHeight);
    this.nearest = Math.max(Math.min(full, ...distances) / 1.8, 1.05 * this.reach);
    this.farthest = Math.max(2 * this.nearest, 6 * full, 2.5 * Math.max(0, ...distances));
  }

  pixelsHigh(distance) {
    return (this.screenHeight * this.size[1]) / (2 * distance * this.tangent);
  }

  distance(pixelsHigh) {
    return (this.screenHeight * this.size[1]) / (2 * pixelsHigh * this.tangent);
  }

  // The coarsest level that is meant for this distance.
  levelAt(distance) {
    let level = 0;
    // A switch distance that a slider stands on counts as reached.
    this.facts.forEach((f, k) => { if (f.distance <= distance * 1.000001) level = k; });
    return level;
  }

  // What is shown at this distance: a level, and the share of its way to the next that it has gone, where it says how
  // it becomes that one. Then it is shown up to the end of its band.
  shownAt(distance) {
    const level = this.levelAt(distance);
    const before = this.facts[level - 1];
    if (!before?.morphs || !before.blend || distance >= before.blend.end) return { level, share: 0 };
    const { begin, end } = before.blend;
    return { level: level - 1, share: clamp((distance - begin) / (end - begin), 0, 1) };
  }

  // Where a distance lies between the nearest and the farthest, 0 to 1, and back.
  share(distance) {
    return clamp(Math.log(distance / this.nearest) / Math.log(this.farthest / this.nearest), 0, 1);
  }

  distanceAt(share) {
    return this.nearest * (this.farthest / this.nearest) ** share;
  }

  // A camera that fills a box with the whole tree, seen from a direction.
  closeUp(orbit, aspect) {
    const tangent = Math.tan((35 * Math.PI) / 360);
    const up = (this.size[1] / 2) * Math.cos(orbit.pitch) + this.reach * Math.abs(Math.sin(orbit.pitch));
    // An upright cylinder about the tree fits in width and in height.
    const wide = this.reach / Math.sin(Math.atan(tangent * aspect));
    const distance = 1.03 * Math.max(up / tangent + this.reach / 2, wide);
    const shift = orbit.shift.map((x) => 2 * x * distance * tangent);
    // Nearer is a narrower view rather than a step forward: no leaf ever comes
    // before the lens.
    return this.camera(orbit, distance, tangent / orbit.zoom, shift);
  }

  // The camera of the screen at a distance, cut down to a box of this size in pixels.
  trueSize(orbit, distance, boxHeight) {
    return this.camera(orbit, distance, (this.tangent * boxHeight) / this.screenHeight, [0, 0]);
  }

  camera(orbit, distance, tangent, [across, up]) {
    const direction = orbit.direction();
    const right = unit(cross([0, 1, 0], direction));
    const target = add(add(this.center, times(right, across)), times(cross(direction, right), up));
    return {
      eye: add(target, times(direction, distance)),
      target,
      tangent,
      near: Math.max(distance - 1.6 * this.radius, distance / 1000),
      far: distance + 1.6 * this.radius,
    };
  }
}
