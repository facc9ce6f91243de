// Draws levels of chains in three.js as its GLTFLoader sets them up, from the distances at which
// they begin and end, and tells how much of the screen they cover: over the truth, which is the
// original with 4 x 4 samples a pixel and without mip maps.
//
// Jobs: [{ name, original, screen: { height_px, fov_degrees }, most_px, levels: [{ file, distances }] }];
// of what is larger on the screen than most_px, the middle is drawn.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const TRUTH_SAMPLES = 4;
// Nearer eyes stand within crowns.
const LEAST_RADII = 3;
const SPECK_PX = 3;
// As people walk about a plant: all around, and a little above.
const VIEWS = [0, 1, 2, 3, 4, 5].map((k) => {
  const [turn, rise] = [(k / 6) * 2 * Math.PI + 0.3, 0.1 + 0.05 * k];
  return new THREE.Vector3(Math.cos(rise) * Math.sin(turn), Math.sin(rise), Math.cos(rise) * Math.cos(turn));
});

const renderer = new THREE.WebGLRenderer({ alpha: true, antialias: false, preserveDrawingBuffer: true });
renderer.setPixelRatio(1);
renderer.setClearColor(0x000000, 0);

const load = async (url) => {
  const { scene: plant } = await new GLTFLoader().loadAsync(url);
  const scene = new THREE.Scene();
  scene.add(plant, new THREE.HemisphereLight(0xffffff, 0x808080, 2));
  scene.updateMatrixWorld(true);
  return scene;
};

const dispose = (scene) => scene.traverse((node) => {
  node.geometry?.dispose();
  node.material?.map?.dispose();
  node.material?.dispose();
});

const withoutMips = (scene) => scene.traverse((node) => {
  const map = node.material?.map;
  if (!map) return;
  map.minFilter = THREE.LinearFilter;
  map.generateMipmaps = false;
  map.needsUpdate = true;
});

// A camera that just holds the plant, or its middle, and the pixels that the screen gives to that.
const cameraFor = ({ centre, radius, height, mostPx }, direction, distance, screen) => {
  const away = Math.max(distance, LEAST_RADII * radius);
  const pixelsHigh = (screen.height_px * height) / (2 * distance * Math.tan((screen.fov_degrees * Math.PI) / 360));
  const tangent = radius / Math.sqrt(away * away - radius * radius);
  const whole = (pixelsHigh * 2 * away * tangent) / height;
  const side = Math.max(1, Math.ceil(Math.min(whole, mostPx)));
  const degrees = (360 / Math.PI) * Math.atan((tangent * side) / whole);
  const camera = new THREE.PerspectiveCamera(degrees, 1, 0.5 * (away - radius), 2 * (away + radius));
  camera.position.copy(centre).addScaledVector(direction, away);
  camera.lookAt(centre);
  return { camera, side };
};

// Which pixels are not background.
const covered = (scene, camera, side) => {
  renderer.setSize(side, side, false);
  renderer.render(scene, camera);
  const gl = renderer.getContext();
  const rgba = new Uint8Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  const is = new Uint8Array(side * side);
  for (let k = 0; k < is.length; k++) is[k] = rgba[4 * k + 3] > 127 ? 1 : 0;
  return is;
};

const sum = (list) => {
  let total = 0;
  for (const value of list) total += value;
  return total;
};

// Islands of up to 3 pixels; pixels that touch at a corner belong together.
const specks = (is, side) => {
  const seen = new Uint8Array(is.length);
  let count = 0;
  for (let first = 0; first < is.length; first++) {
    if (!is[first] || seen[first]) continue;
    const island = [first];
    seen[first] = 1;
    for (let at = 0; at < island.length; at++) {
      const [x, y] = [island[at] % side, Math.floor(island[at] / side)];
      for (let row = Math.max(y - 1, 0); row <= Math.min(y + 1, side - 1); row++) {
        for (let column = Math.max(x - 1, 0); column <= Math.min(x + 1, side - 1); column++) {
          const next = row * side + column;
          if (is[next] && !seen[next]) {
            seen[next] = 1;
            island.push(next);
          }
        }
      }
    }
    if (island.length <= SPECK_PX) count++;
  }
  return count;
};

// What is seen of a plant from one distance: pixels, and specks a view.
const seenOf = (scene, plant, distance, screen, samples) => {
  const pictures = VIEWS.map((direction) => {
    const { camera, side } = cameraFor(plant, direction, distance, screen);
    const is = covered(scene, camera, side * samples);
    return { pixels: sum(is) / (samples * samples), specks: samples === 1 ? specks(is, side) : 0 };
  });
  const total = (key) => sum(pictures.map((picture) => picture[key]));
  return { pixels: total("pixels"), specks: total("specks") / VIEWS.length };
};

const run = async () => {
  const jobs = await (await fetch("/jobs")).json();
  const results = [];
  for (const { name, original, screen, most_px: mostPx, levels } of jobs) {
    const [whole, truth] = [await load(original), await load(original)];
    withoutMips(truth);
    const box = new THREE.Box3().setFromObject(whole);
    const [size, sphere] = [box.getSize(new THREE.Vector3()), box.getBoundingSphere(new THREE.Sphere())];
    const plant = { centre: sphere.center, radius: sphere.radius, height: size.y, mostPx };
    const truths = new Map();
    const truthAt = (distance) => {
      if (!truths.has(distance)) {
        const { pixels } = seenOf(truth, plant, distance, screen, TRUTH_SAMPLES);
        truths.set(distance, { pixels, original: seenOf(whole, plant, distance, screen, 1) });
      }
      return truths.get(distance);
    };
    for (const [number, { file, distances }] of levels.entries()) {
      const level = await load(file);
      for (const distance of distances) {
        const { pixels, original: before } = truthAt(distance);
        const seen = seenOf(level, plant, distance, screen, 1);
        results.push({
          name,
          level: number,
          distance,
          coverage_over_truth: seen.pixels / pixels,
          original_coverage_over_truth: before.pixels / pixels,
          specks_per_view: seen.specks,
          original_specks_per_view: before.specks,
        });
      }
      dispose(level);
    }
    [whole, truth].forEach(dispose);
  }
  return results;
};

const tell = (answer) => fetch("/done", { method: "POST", body: JSON.stringify(answer) });
addEventListener("error", (e) => tell({ error: e.message || `${e.target.src ?? e.target} failed` }), true);
addEventListener("unhandledrejection", (e) => tell({ error: String(e.reason?.stack ?? e.reason) }));
run().then((results) => tell({ results }), (problem) => tell({ error: String(problem.stack ?? problem) }));
