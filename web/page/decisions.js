// What a person has decided, and all that was decided before: undo and redo without end.

const FIRST = {
  // Selectors of leaves; empty where the evidence decides.
  leaves: [],
  // Selectors of what is not the plant, beside ground and helpers.
  notPlant: [],
  // Whether levels say what they hang on, so that they sway.
  wind: false,
  // How much work goes into levels: "fast", "normal" or "best".
  effort: "normal",
  // "chain" or "level".
  kind: "chain",
  level: { amount: "share", value: 0.25 },
  // What a chain is for: "heights", "distances" or "shares".
  levels: "heights",
  distances: [5, 20, 80],
  shares: [0.5, 0.25, 0.1],
  maxDifference: 0.28,
  original: true,
  impostor: true,
  // The level that is looked at; null: as the distance has it.
  shown: null,
};

class Decisions {
  constructor(onChange) {
    this.onChange = onChange;
    this.begin();
  }

  // Of another plant: targets stay but for what is known of it, what was said of leaves does not; or of one that
  // was left, as kept.
  begin(kept, known) {
    const now = { ...(this.now ?? FIRST), leaves: [], notPlant: [], ...known, shown: null };
    Object.assign(this, kept ?? { past: [], future: [], now });
    this.joins = null;
  }

  get kept() {
    const { past, future, now } = this;
    return { past, future, now };
  }

  // Decides; a change of the same thing within a moment, as by a slider that is dragged, is one step.
  decide(change, joins = null) {
    const next = { ...this.now, ...change };
    if (JSON.stringify(next) === JSON.stringify(this.now)) return;
    const time = performance.now();
    const isSame = joins !== null && this.joins === joins && time - this.time < 800;
    if (!isSame) this.past.push(this.now);
    Object.assign(this, { future: [], now: next, joins, time });
    this.onChange();
  }

  step(from, to) {
    if (from.length === 0) return;
    to.push(this.now);
    this.now = from.pop();
    this.joins = null;
    this.onChange();
  }

  undo() {
    this.step(this.past, this.future);
  }

  redo() {
    this.step(this.future, this.past);
  }

  // What the engine is asked for.
  get settings() {
    const { kind, level, levels, maxDifference, original, impostor, effort } = this.now;
    if (kind === "level") return { ...level, effort };
    const values = { heights: undefined, distances: this.now.distances, shares: this.now.shares }[levels];
    return { levels, ...(values && { values }), maxDifference, original, impostor, effort };
  }

  // How the plant is opened, as JSON.
  get opening() {
    const { leaves, notPlant, wind } = this.now;
    return JSON.stringify({ leaves, notPlant, wind });
  }

  // What a result is known by.
  get key() {
    return JSON.stringify([this.opening, this.now.kind, this.settings]);
  }
}
