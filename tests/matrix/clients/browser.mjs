// Opens files in a page of a headless Chromium, and takes a picture of each:
//     node browser.mjs MODULES PAGE < tasks.json
// Tasks are [{row, root, file, box, shot}]; the answer, a line of JSON a task, is what the page said of the file.
import { readFileSync } from 'node:fs';
import { readFile, readdir, stat } from 'node:fs/promises';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

const [modules, client] = process.argv.slice(2);
const puppeteer = createRequire(join(modules, 'x.js'))('puppeteer-core');
const tasks = JSON.parse(readFileSync(0, 'utf8'));
const here = dirname(fileURLToPath(import.meta.url));
const roots = { clients: here, modules, files: tasks[0]?.root };
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm', '.png': 'image/png', '.json': 'application/json' };

// Threads of WebAssembly want a page that is isolated.
const HEADERS = { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' };
const server = createServer(async (request, response) => {
  try {
    const [, root, ...rest] = decodeURIComponent(new URL(request.url, 'http://localhost').pathname).split('/');
    const path = join(roots[root], normalize('/' + rest.join('/')));
    const isFolder = (await stat(path)).isDirectory();
    const body = isFolder ? JSON.stringify(await readdir(path)) : await readFile(path);
    response.writeHead(200, { ...HEADERS, 'Content-Type': isFolder ? 'application/json' : TYPES[extname(path)] ?? 'application/octet-stream' });
    response.end(body);
  } catch {
    response.writeHead(404, HEADERS);
    response.end();
  }
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const address = `http://127.0.0.1:${server.address().port}`;

// A file that brings the page down leaves the others a new browser.
let browser;
let page;
async function fresh() {
  browser?.process().kill('SIGKILL');
  browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    defaultViewport: { width: 400, height: 400 },
    protocolTimeout: 60_000,
  });
  page = await browser.newPage();
  page.said = [];
  page.on('console', (message) => page.said.push(message.text()));
  page.on('pageerror', (error) => page.said.push(String(error)));
  await page.goto(`${address}/clients/${client}.html`);
  await page.evaluate(() => window.start?.());
  await page.waitForFunction(() => window.isReady, { timeout: 40_000 });
}

await fresh();
console.log(JSON.stringify({ version: await page.evaluate(() => window.version) }));
for (const task of tasks) {
  let answer;
  try {
    if (!page) await fresh();
    page.said = [];
    await page.evaluate((url, box) => { window.answer = ''; return window.open_file(url, box); }, `${address}/files/${task.file}`, task.box);
    await page.waitForFunction(() => window.answer, { timeout: 60_000 });
    answer = JSON.parse(await page.evaluate(() => window.answer));
    if (!answer.error && task.shot) await page.screenshot({ path: task.shot });
    answer.said = [...page.said, ...(await page.evaluate(() => window.said ?? []))].slice(0, 8);
  } catch (error) {
    answer = { error: String(error).split('\n')[0], said: page?.said ?? [] };
    page = undefined;
  }
  console.log(JSON.stringify({ row: task.row, ...answer }));
}
browser.process().kill('SIGKILL');
server.close();
