// A loop that is drawn over the plant, with a mouse, a pen or a finger.

// Corners of a loop are at least this far apart, in pixels of the page.
const LEAST_STEP = 3;
// A loop of fewer corners is a click.
const LEAST_CORNERS = 6;

class Lasso {
  // sheet: what lies over the picture below while there is a lasso, and leaves it the wheel; onLoop is called with corners
  // from -1, -1 at the lower left.
  constructor(sheet, below, onLoop) {
    this.sheet = sheet;
    this.line = sheet.firstElementChild;
    this.onLoop = onLoop;
    this.corners = [];
    sheet.addEventListener("pointerdown", (e) => this.begin(e));
    sheet.addEventListener("pointermove", (e) => this.follow(e));
    sheet.addEventListener("pointerup", (e) => this.end(e));
    sheet.addEventListener("pointercancel", () => this.clear());
    sheet.addEventListener("wheel", (e) => {
      e.preventDefault();
      below.dispatchEvent(new WheelEvent("wheel", e));
    }, { passive: false });
  }

  get isOn() {
    return !this.sheet.hasAttribute("hidden");
  }

  turn(isOn) {
    this.clear();
    this.sheet.toggleAttribute("hidden", !isOn);
  }

  // In pixels of the page, from the upper left of the picture.
  placeOf(e) {
    const { left, top } = this.sheet.getBoundingClientRect();
    return [e.clientX - left, e.clientY - top];
  }

  begin(e) {
    if (!e.isPrimary || e.button !== 0) return;
    this.sheet.setPointerCapture(e.pointerId);
    this.corners = [this.placeOf(e)];
  }

  follow(e) {
    if (!e.isPrimary || this.corners.length === 0) return;
    const [[x, y], next] = [this.corners.at(-1), this.placeOf(e)];
    if (Math.hypot(next[0] - x, next[1] - y) < LEAST_STEP) return;
    this.corners.push(next);
    this.line.setAttribute("points", this.corners.map((corner) => corner.join()).join(" "));
  }

  end(e) {
    if (!e.isPrimary) return;
    const { width, height } = this.sheet.getBoundingClientRect();
    const corners = this.corners.map(([x, y]) => [(2 * x) / width - 1, 1 - (2 * y) / height]);
    this.clear();
    if (corners.length >= LEAST_CORNERS) this.onLoop(corners);
  }

  clear() {
    this.corners = [];
    this.line.setAttribute("points", "");
  }
}

// L: a lasso, over the plant alone.
const turnLasso = (isOn = !lasso.isOn) => {
  if (isOn) setMode("plant");
  lasso.turn(isOn);
  say();
};

const sayLasso = () => {
  if (lasso.isOn && !stage.isAlone) lasso.turn(false);
  press($("lasso"), lasso.isOn);
  $("lasso-level").hidden = !lasso.isOn;
};
