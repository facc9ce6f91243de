// Makes levels of a plant: node examples/node.mjs tree.glb levels
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import secateur from "../nodejs/secateur.js";

const [plant, folder] = process.argv.slice(2);
const tree = new secateur.Tree(basename(plant), readFileSync(plant), "[]");
if (tree.problem()) throw new Error(tree.problem());
const levels = tree.levels(JSON.stringify({ levels: "heights" }), () => {});
mkdirSync(folder, { recursive: true });
levels.names("files").forEach((name, k) => writeFileSync(join(folder, name), levels.file("files", k)));
