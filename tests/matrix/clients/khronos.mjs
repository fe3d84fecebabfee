// The Khronos validator: node khronos.mjs MODULES < tasks.json
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';

const { validateBytes, version } = createRequire(join(process.argv[2], 'x.js'))('gltf-validator');
console.log(JSON.stringify({ version: version() }));
for (const task of JSON.parse(readFileSync(0, 'utf8'))) {
  const path = join(task.root, task.file);
  const externalResourceFunction = async (uri) => new Uint8Array(readFileSync(join(dirname(path), decodeURIComponent(uri))));
  const { issues } = await validateBytes(new Uint8Array(readFileSync(path)), { uri: path, externalResourceFunction });
  const messages = issues.messages.filter(({ severity }) => severity < 2)
    .map(({ code, message, pointer }) => `${code}: ${message} ${pointer ?? ''}`);
  console.log(JSON.stringify({ row: task.row, messages }));
}
