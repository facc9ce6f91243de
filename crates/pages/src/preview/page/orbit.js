// One camera for all pictures: turned by dragging, moved nearer by the wheel, by
// two fingers or by keys.

const STEEPEST = 1.5;
const ZOOMS = [0.25, 40];
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

class Orbit {
  constructor(canvas, onChange) {
    this.onChange = onChange;
    this.fingers = new Map();
    this.reset();
    canvas.addEventListener("pointerdown", (e) => {
      canvas.setPointerCapture(e.pointerId);
      this.fingers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(end, (e) => this.fingers.delete(e.pointerId));
    }
    canvas.addEventListener("pointermove", (e) => this.follow(e, canvas.clientHeight));
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      const pixels = e.deltaMode === 1 ? 30 * e.deltaY : e.deltaY;
      this.nearer(Math.exp(-0.0016 * pixels));
    }, { passive: false });
    canvas.addEventListener("contextmenu", (e) => e.preventDefault());
    canvas.addEventListener("dblclick", () => this.reset());
    canvas.addEventListener("keydown", (e) => this.key(e));
  }

  reset() {
    Object.assign(this, { yaw: 0.6, pitch: 0.12, zoom: 1, shift: [0, 0] });
    this.onChange();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = clamp(this.pitch + pitch, -STEEPEST, STEEPEST);
    this.onChange();
  }

  nearer(factor) {
    this.zoom = clamp(this.zoom * factor, ...ZOOMS);
    this.onChange();
  }

  // By shares of the picture's height.
  move(across, up) {
    this.shift = [this.shift[0] + across / this.zoom, this.shift[1] + up / this.zoom].map((x) => clamp(x, -1, 1));
    this.onChange();
  }

  follow(e, height) {
    const finger = this.fingers.get(e.pointerId);
    if (!finger) return;
    const before = this.spread();
    const [dx, dy] = [e.clientX - finger.x, e.clientY - finger.y];
    Object.assign(finger, { x: e.clientX, y: e.clientY });
    if (this.fingers.size > 1) {
      this.nearer(this.spread() / before);
      this.move(-dx / height / this.fingers.size, dy / height / this.fingers.size);
    } else if (e.shiftKey || e.buttons & 6) {
      this.move(-dx / height, dy / height);
    } else {
      this.turn(-0.008 * dx, 0.008 * dy);
    }
  }

  // How far apart two fingers are.
  spread() {
    const [a, b] = [...this.fingers.values()];
    return b ? Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1) : 1;
  }

  key(e) {
    const step = 0.1;
    const keys = {
      ArrowLeft: () => this.turn(-step, 0),
      ArrowRight: () => this.turn(step, 0),
      ArrowUp: () => this.turn(0, step),
      ArrowDown: () => this.turn(0, -step),
      "+": () => this.nearer(1.15),
      "=": () => this.nearer(1.15),
      "-": () => this.nearer(1 / 1.15),
      Home: () => this.reset(),
    };
    if (!keys[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    keys[e.key]();
  }

  // From the target to the eye.
  direction() {
    const flat = Math.cos(this.pitch);
    return [flat * Math.sin(this.yaw), Math.sin(this.pitch), flat * Math.cos(this.yaw)];
  }
}
