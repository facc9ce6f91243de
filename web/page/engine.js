// The page's side of the worker: calls, progress, and an end within a moment.

class Engine {
  // module: the compiled engine, or what promises it.
  constructor(module, script) {
    this.module = module;
    this.address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    this.start();
  }

  start() {
    this.waiting = new Map();
    this.lastId = 0;
    // What is open over there.
    this.open = null;
    const worker = new Worker(this.address);
    this.worker = worker;
    worker.onmessage = ({ data }) => this.hear(data);
    worker.onerror = (event) => this.fail(`The engine does not start: ${event.message}`);
    this.module.then((engine) => worker.postMessage({ engine })).catch((error) => this.fail(`The engine does not start: ${error.message}`));
  }

  fail(sentence) {
    for (const { reject } of this.waiting.values()) reject(new Error(sentence));
    this.waiting.clear();
  }

  hear({ id, value, error, progress, isBroken }) {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    if (progress) return waiting.tell?.(progress);
    this.waiting.delete(id);
    if (isBroken) this.cancel();
    if (error === undefined) waiting.resolve(value);
    else waiting.reject(new Error(error));
  }

  // Calls follow each other; the promise is broken off by cancel().
  call(call, given, tell = null) {
    const id = ++this.lastId;
    const promise = new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject, tell }));
    this.module.then(() => this.waiting.has(id) && this.worker.postMessage({ id, call, given }));
    return promise;
  }

  // Ends whatever is being done, at once: the worker goes, and another comes.
  cancel() {
    this.worker.terminate();
    const waiting = [...this.waiting.values()];
    this.start();
    for (const { reject } of waiting) reject(new Cancelled());
  }
}

class Cancelled extends Error {}
