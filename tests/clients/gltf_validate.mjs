// Validates glTF files with the Khronos validator: node gltf_validate.mjs MODULES FILE...
// Prints a JSON object: file -> { errors, warnings, infos, hints, messages }.
import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";

const [modules, ...files] = process.argv.slice(2);
const validator = createRequire(path.join(modules, "x.js"))("gltf-validator");
const reports = {};
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 100,
    externalResourceFunction: async (uri) =>
      new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
  }).catch((error) => ({ issues: { numErrors: 1, messages: [{ severity: 0, code: "UNREADABLE", message: String(error) }] } }));
  reports[file] = report.issues;
}
console.log(JSON.stringify(reports));
