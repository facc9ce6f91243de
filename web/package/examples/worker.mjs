// A Worker for a bundler (webpack with experiments.asyncWebAssembly, Vite with vite-plugin-wasm):
//   const worker = new Worker(new URL("./worker.mjs", import.meta.url), { type: "module" });
//   worker.onmessage = ({ data }) => console.log(data.glb ?? data.error ?? data.progress);
//   worker.postMessage({ name: "tree.glb", bytes, share: 0.25 });
import { Tree } from "../bundler/secateur.js";

self.onmessage = ({ data: { name, bytes, share } }) => {
  try {
    const tree = new Tree(name, bytes, "[]");
    if (tree.problem()) throw tree.problem();
    const told = (stage, progress) => postMessage({ stage, progress });
    postMessage({ glb: tree.level(JSON.stringify({ amount: "share", value: share }), told).glb() });
  } catch (error) {
    postMessage({ error: String(error) });
  }
};
