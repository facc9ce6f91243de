// Usage: node validate.mjs FILE... : one line of JSON per file, with the
// Khronos validator's counts and its errors and warnings. Exit 1 if any file
// has an error or cannot be read.
import { readFile } from "node:fs/promises";
import { basename, dirname, resolve } from "node:path";
import validator from "gltf-validator";

const SEVERITY = ["error", "warning", "info", "hint"];

async function validate(file) {
  const bytes = await readFile(file);
  const report = await validator.validateBytes(new Uint8Array(bytes), {
    uri: basename(file),
    maxIssues: 0,
    writeTimestamp: false,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(resolve(dirname(file), decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  const worthTelling = messages
    .filter(({ severity }) => severity <= 1)
    .slice(0, 20)
    .map(({ severity, code, message, pointer }) => ({ severity: SEVERITY[severity], code, message, pointer }));
  console.log(
    JSON.stringify({
      file,
      errors: numErrors,
      warnings: numWarnings,
      infos: numInfos,
      hints: numHints,
      unused: messages.filter(({ code }) => code === "UNUSED_OBJECT").map(({ pointer }) => pointer),
      messages: worthTelling,
    }),
  );
  return numErrors > 0;
}

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node validate.mjs FILE...");
  process.exit(2);
}
let failed = false;
for (const file of files) {
  try {
    failed = (await validate(file)) || failed;
  } catch (problem) {
    console.log(JSON.stringify({ file, errors: 1, messages: [{ severity: "error", message: String(problem) }] }));
    failed = true;
  }
}
process.exit(failed ? 1 : 0);
