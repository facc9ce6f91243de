// Draws every level of chains as a client that knows glTF would, once in three.js
// and once in Babylon.js, and tells what it saw: triangles, and the picture.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { Scene } from "@babylonjs/core/scene.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { HemisphericLight } from "@babylonjs/core/Lights/hemisphericLight.js";
import { Color3, Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { ImportMeshAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { SceneLoader } from "@babylonjs/core/Loading/sceneLoader.js";
import "@babylonjs/loaders/glTF/2.0/index.js";

const SIZE = 192;
const BACKGROUND = [0, 0, 255];

// What of a picture is not background, in how many colours, and its pixels.
const seen = (rgba) => {
  let covered = 0;
  const colours = new Set();
  for (let at = 0; at < rgba.length; at += 4) {
    const [r, g, b] = rgba.subarray(at, at + 3);
    if (Math.abs(r - BACKGROUND[0]) + Math.abs(g - BACKGROUND[1]) + Math.abs(b - BACKGROUND[2]) > 24) {
      covered++;
      colours.add((r << 16) | (g << 8) | b);
    }
  }
  return { covered, colours: colours.size, rgba };
};

// Pixels that are another colour.
const different = (a, b) => {
  let count = 0;
  for (let at = 0; at < a.length; at += 4) {
    if (Math.max(...[0, 1, 2].map((k) => Math.abs(a[at + k] - b[at + k]))) > 24) count++;
  }
  return count;
};

const eyeFor = ({ centre, radius }) => ({
  eye: [centre[0] + 0.8 * radius, centre[1] + 0.5 * radius, centre[2] + 2.4 * radius],
  target: centre,
  near: radius / 50,
  far: radius * 50,
});

const three = {
  async load(url, view) {
    const gltf = await new GLTFLoader().loadAsync(url);
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0x0000ff);
    scene.add(gltf.scene, new THREE.HemisphereLight(0xffffff, 0x808080, 2));
    scene.updateMatrixWorld(true);
    if (!view.centre) {
      const sphere = new THREE.Box3().setFromObject(gltf.scene).getBoundingSphere(new THREE.Sphere());
      Object.assign(view, { centre: sphere.center.toArray(), radius: sphere.radius });
    }
    return { gltf, scene };
  },
  draw({ scene }, view) {
    const { eye, target, near, far } = eyeFor(view);
    const camera = new THREE.PerspectiveCamera(50, 1, near, far);
    camera.position.set(...eye);
    camera.lookAt(...target);
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(SIZE, SIZE, false);
    renderer.render(scene, camera);
    const gl = renderer.getContext();
    const rgba = new Uint8Array(4 * SIZE * SIZE);
    gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    const { triangles } = renderer.info.render;
    renderer.dispose();
    renderer.forceContextLoss();
    return { triangles, ...seen(rgba) };
  },
  async levels(layout, urls, names, view) {
    const pictures = [];
    let coverage = null;
    if (layout === "Files") {
      for (const [k, url] of urls.entries()) {
        const loaded = await this.load(url, view);
        if (!loaded.gltf.scene.getObjectByName(names[k])) throw new Error(`no ${names[k]}`);
        pictures.push(this.draw(loaded, view));
      }
    } else if (layout === "Siblings") {
      const loaded = await this.load(urls[0], view);
      const levels = names.map((name) => loaded.gltf.scene.getObjectByName(name));
      for (const shown of levels) {
        for (const level of levels) level.visible = level === shown;
        pictures.push(this.draw(loaded, view));
      }
    } else {
      const loaded = await this.load(urls[0], view);
      const { parser } = loaded.gltf;
      const finest = parser.json.nodes.findIndex((node) => node.name === names[0]);
      const { ids } = parser.json.nodes[finest].extensions.MSFT_lod;
      const first = loaded.gltf.scene.getObjectByName(names[0]);
      coverage = first.userData.MSFT_screencoverage;
      pictures.push(this.draw(loaded, view));
      const parent = first.parent;
      first.removeFromParent();
      for (const id of ids) {
        const level = await parser.getDependency("node", id);
        parent.add(level);
        pictures.push(this.draw(loaded, view));
        level.removeFromParent();
      }
    }
    return { pictures, coverage };
  },
};

// A disposed engine keeps its context until it is collected, and of too many a browser loses the oldest.
const release = (engine) => {
  const context = engine.getRenderingCanvas().getContext("webgl2");
  engine.dispose();
  context?.getExtension("WEBGL_lose_context")?.loseContext();
};

const babylon = {
  async load(url, view, maxLODsToLoad = 10) {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = SIZE;
    const engine = new Engine(canvas, false, { preserveDrawingBuffer: true });
    const scene = new Scene(engine);
    scene.useRightHandedSystem = true;
    scene.clearColor = new Color4(0, 0, 1, 1);
    const light = new HemisphericLight("sky", new Vector3(0, 1, 0), scene);
    light.groundColor = new Color3(0.5, 0.5, 0.5);
    light.intensity = 2;
    let completed;
    const whole = new Promise((resolve) => { completed = resolve; });
    SceneLoader.OnPluginActivatedObservable.addOnce((loader) => {
      loader.onCompleteObservable.add(completed);
    });
    const pluginOptions = { gltf: { extensionOptions: { MSFT_lod: { maxLODsToLoad } } } };
    await ImportMeshAsync(url, scene, { pluginOptions, pluginExtension: ".glb" });
    // Finer levels are still on their way when the first is there.
    await whole;
    return { engine, scene };
  },
  async draw({ engine, scene }, view) {
    const { eye, target, near, far } = eyeFor(view);
    const camera = new FreeCamera("eye", new Vector3(...eye), scene);
    camera.setTarget(new Vector3(...target));
    Object.assign(camera, { fov: (50 * Math.PI) / 180, minZ: near, maxZ: far });
    scene.activeCamera = camera;
    await scene.whenReadyAsync();
    scene.render();
    const rgba = new Uint8Array((await engine.readPixels(0, 0, SIZE, SIZE)).buffer);
    camera.dispose();
    const drawn = scene.meshes.filter((mesh) => mesh.isEnabled() && mesh.getTotalIndices() > 0);
    const placed = (mesh) => (mesh.thinInstanceCount || 1);
    const triangles = drawn.reduce((sum, mesh) => sum + (mesh.getTotalIndices() / 3) * placed(mesh), 0);
    return { triangles, ...seen(rgba) };
  },
  async levels(layout, urls, names, view) {
    const pictures = [];
    let coverage = null;
    const one = async (url, most) => {
      const loaded = await this.load(url, view, most);
      pictures.push(await this.draw(loaded, view));
      return loaded;
    };
    if (layout === "Files") {
      for (const url of urls) release((await one(url)).engine);
    } else if (layout === "Siblings") {
      const loaded = await this.load(urls[0], view);
      // It takes skinned meshes out of their nodes; their names tell.
      const isOf = (mesh, name) => mesh.name === name || mesh.name.startsWith(`${name}_primitive`);
      const levels = names.map((name) => [
        loaded.scene.getNodeByName(name),
        ...loaded.scene.meshes.filter((mesh) => isOf(mesh, name)),
      ]);
      for (const shown of levels) {
        for (const level of levels) level.forEach((node) => node.setEnabled(level === shown));
        pictures.push(await this.draw(loaded, view));
      }
      release(loaded.engine);
    } else {
      // It loads the coarsest level first and lets each finer one take its place.
      for (let k = 0; k < names.length; k++) {
        const { engine, scene } = await one(urls[0], names.length - k);
        if (k === 0) coverage = scene.getNodeByName(names[0]).metadata.gltf.extras.MSFT_screencoverage;
        release(engine);
      }
    }
    return { pictures, coverage };
  },
};

const run = async () => {
  const jobs = await (await fetch("/jobs")).json();
  const results = [];
  for (const { name, input, layouts } of jobs) {
    const view = {};
    await three.load(input, view);
    for (const [client, it] of Object.entries({ three, babylon })) {
      const loaded = await it.load(input, view);
      const original = await it.draw(loaded, view);
      if (loaded.engine) release(loaded.engine);
      for (const { layout, files, names } of layouts) {
        const { pictures, coverage } = await it.levels(layout, files, names, view);
        results.push({
          name,
          client,
          layout,
          coverage,
          differs_from_input: different(original.rgba, pictures[0].rgba) / (SIZE * SIZE),
          levels: pictures.map(({ triangles, covered, colours }) => ({
            triangles,
            covered: covered / (SIZE * SIZE),
            colours,
          })),
        });
      }
    }
  }
  return results;
};

const tell = (answer) => fetch("/done", { method: "POST", body: JSON.stringify(answer) });
addEventListener("error", (e) => tell({ error: e.message || `${e.target.src ?? e.target} failed` }), true);
addEventListener("unhandledrejection", (e) => tell({ error: String(e.reason?.stack ?? e.reason) }));
run().then((results) => tell({ results }), (problem) => tell({ error: String(problem.stack ?? problem) }));
