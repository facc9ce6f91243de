// Usage: node clients.mjs BROWSER JOBS.json PAGE.js : opens page.js or coverage.js in the
// browser, without a window, and prints what it tells, one line of JSON. Exit 1 if it tells of
// an error, or nothing for five minutes. JOBS.json names files beside it; for page.js it is
// [{name, input, layouts: [{layout, files, names}]}], for coverage.js see there.
import { spawn } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const PATIENCE_MS = 300_000;
const here = dirname(fileURLToPath(import.meta.url));
const [browser, jobs, script] = process.argv.slice(2);
if (!["page.js", "coverage.js"].includes(script)) {
  console.error("usage: node clients.mjs BROWSER JOBS.json PAGE.js");
  process.exit(2);
}
const modules = {
  "three": "/modules/three/build/three.module.js",
  "three/addons/": "/modules/three/examples/jsm/",
  "@babylonjs/core/": "/modules/@babylonjs/core/",
};
// Packages name each other's files from within; the page names them like this too.
modules["@babylonjs/loaders/"] = "/modules/@babylonjs/loaders/";
const page = `<!DOCTYPE html><meta charset="utf-8"><title>clients</title>
<script type="importmap">${JSON.stringify({ imports: modules })}</script>
<script type="module" src="/${script}"></script>`;
const TYPES = { ".js": "text/javascript", ".glb": "model/gltf-binary", ".json": "application/json" };

let finish;
const answer = new Promise((resolve) => { finish = resolve; });

const fileOf = (path) => {
  const plain = normalize(decodeURIComponent(path));
  if (plain === `/${script}`) return join(here, script);
  if (plain === "/jobs") return jobs;
  if (plain.startsWith("/modules/")) return join(here, "node_modules", plain.slice("/modules/".length));
  return join(dirname(jobs), plain);
};

const server = createServer(async (request, response) => {
  const { pathname } = new URL(request.url, "http://localhost");
  if (request.method === "POST") {
    const parts = [];
    for await (const part of request) parts.push(part);
    response.end();
    finish(JSON.parse(Buffer.concat(parts).toString()));
    return;
  }
  if (pathname === "/") {
    response.writeHead(200, { "content-type": "text/html" }).end(page);
    return;
  }
  if (pathname === "/favicon.ico") {
    response.writeHead(204).end();
    return;
  }
  try {
    const path = fileOf(pathname);
    const type = TYPES[extname(path)] ?? "application/octet-stream";
    response.writeHead(200, { "content-type": type }).end(await readFile(path));
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));

const profile = await mkdtemp(join(tmpdir(), "secateur-clients-"));
const child = spawn(
  browser,
  [
    "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-extensions", "--disable-background-networking",
    "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--remote-debugging-port=0", "--enable-logging=stderr",
    `--user-data-dir=${profile}`, `http://127.0.0.1:${server.address().port}/`,
  ],
  { stdio: ["ignore", "ignore", "pipe"] },
);
let log = "";
child.stderr.on("data", (text) => { log += text; });
child.on("error", (problem) => finish({ error: String(problem) }));
const timer = setTimeout(() => finish({ error: "the page told nothing" }), PATIENCE_MS);
const told = await answer;
clearTimeout(timer);
const gone = new Promise((resolve) => child.on("exit", resolve));
if (child.exitCode === null && child.pid) {
  child.kill("SIGKILL");
  await gone;
}
server.closeAllConnections();
server.close();
await rm(profile, { recursive: true, force: true, maxRetries: 5 });
if (told.error) {
  console.error(told.error);
  console.error(log.split("\n").filter((line) => line.includes("CONSOLE")).join("\n"));
  process.exit(1);
}
console.log(JSON.stringify(told.results));
