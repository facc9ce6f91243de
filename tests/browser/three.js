// Draws a .glb file with three.js: its defaults, and the given lights and camera.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const linear = (rgb) => new THREE.Color().setRGB(...rgb, THREE.LinearSRGBColorSpace);

window.drawWithThree = async (base64, camera, light, width, height) => {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const { scene: tree } = await new GLTFLoader().parseAsync(bytes.buffer, "");
  const scene = new THREE.Scene();
  scene.background = new THREE.Color().setRGB(...light.background, THREE.SRGBColorSpace);
  const sun = new THREE.DirectionalLight(linear(light.sun), 1);
  sun.position.set(...light.toSun);
  scene.add(tree, sun, new THREE.HemisphereLight(linear(light.sky), linear(light.ground), 1));
  const degrees = (360 / Math.PI) * Math.atan(camera.tangent);
  const eye = new THREE.PerspectiveCamera(degrees, width / height, camera.near, camera.far);
  eye.position.set(...camera.eye);
  eye.lookAt(...camera.target);
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height);
  renderer.render(scene, eye);
  const url = renderer.domElement.toDataURL("image/png");
  renderer.dispose();
  renderer.forceContextLoss();
  return url;
};
document.documentElement.dataset.ready = "1";
