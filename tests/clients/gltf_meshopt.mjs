// Decodes the compressed views of a glTF file with meshoptimizer's decoder:
//   node gltf_meshopt.mjs MODULES DOCUMENT.json BUFFER.bin OUT.bin
// DOCUMENT is the JSON, BUFFER its first buffer. Writes the decoded views one after the other.
import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const [modules, document, buffer, out] = process.argv.slice(2);
const resolved = createRequire(path.join(modules, "x.js")).resolve("meshoptimizer/decoder");
const { MeshoptDecoder } = await import(pathToFileURL(resolved));
await MeshoptDecoder.ready;
const bytes = new Uint8Array(fs.readFileSync(buffer));
const pieces = [];
for (const view of JSON.parse(fs.readFileSync(document)).bufferViews) {
  const own = view.extensions?.EXT_meshopt_compression;
  if (!own) continue;
  const target = new Uint8Array(own.count * own.byteStride);
  const source = bytes.subarray(own.byteOffset ?? 0, (own.byteOffset ?? 0) + own.byteLength);
  MeshoptDecoder.decodeGltfBuffer(target, own.count, own.byteStride, source, own.mode, own.filter ?? "NONE");
  pieces.push(target);
}
fs.writeFileSync(out, Buffer.concat(pieces));
