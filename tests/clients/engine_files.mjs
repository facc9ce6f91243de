// Loads levels by the module that `lods --for` wrote beside them, and prints which level is drawn just before and just
// after each of its distances. Run beside the files: node look.mjs three|babylon
import { readFileSync } from "node:fs";

const engine = process.argv[2];
const module = await import(`./oak.${engine}.js`);
const file = readFileSync(module.FILE);
const near = 0.999, far = 1.001;
const distances = module.LEVELS.slice(1).flatMap(([, m]) => [m * near, m * far]);

/** The scene of a GLB as three.js has it, without geometry: what a loader of pictures needs is not there in node. */
async function asThree() {
  const { Object3D, PerspectiveCamera } = await import("three");
  const length = file.readUInt32LE(12);
  const json = JSON.parse(file.subarray(20, 20 + length).toString());
  const made = (index) => {
    const node = json.nodes[index];
    const object = new Object3D();
    object.name = node.name;
    object.userData = node.extras ?? {};
    for (const child of node.children ?? []) object.add(made(child));
    return object;
  };
  const scene = new Object3D();
  for (const root of json.scenes[json.scene ?? 0].nodes) scene.add(made(root));
  const lod = module.lodOf({ scene });
  const seen = [];
  // The first look is from near by: before it all levels are shown.
  for (const distance of [0, ...distances]) {
    const camera = new PerspectiveCamera();
    camera.position.set(0, 0, distance);
    camera.updateMatrixWorld();
    lod.updateMatrixWorld();
    lod.update(camera);
    seen.push(lod.levels.find(({ object }) => object.visible).object.name);
  }
  return seen.slice(1);
}

async function asBabylon() {
  const { Logger } = await import("@babylonjs/core/Misc/logger.js");
  Logger.LogLevels = Logger.NoneLogLevel;
  const { NullEngine } = await import("@babylonjs/core/Engines/nullEngine.js");
  const { Scene } = await import("@babylonjs/core/scene.js");
  const { FreeCamera } = await import("@babylonjs/core/Cameras/freeCamera.js");
  const { Vector3 } = await import("@babylonjs/core/Maths/math.vector.js");
  const scene = new Scene(new NullEngine());
  const url = `data:model/gltf-binary;base64,${file.toString("base64")}`;
  const finest = await module.load(scene, url);
  const [mesh] = finest;
  const centre = mesh.getBoundingInfo().boundingSphere.centerWorld;
  return distances.map((distance) => {
    const camera = new FreeCamera("eye", centre.add(new Vector3(0, 0, distance)), scene);
    camera.computeWorldMatrix(true);
    const drawn = mesh.getLOD(camera);
    return drawn.name.replace(/_primitive\d+$/, "");
  });
}

console.log(JSON.stringify(engine === "three" ? await asThree() : await asBabylon()));
process.exit(0);
