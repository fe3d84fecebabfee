// Opens pages of the format `html` as files in a headless Chromium without the net, and takes a picture of each:
//     node pages.mjs MODULES < tasks.json
// Tasks are [{row, root, file, season, shot}]; the answer, a line of JSON a task, has what the buttons of the page say, and a star
// behind those that are pressed.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules] = process.argv.slice(2);
const puppeteer = createRequire(join(modules, 'x.js'))('puppeteer-core');
const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
  defaultViewport: { width: 800, height: 1000 },
  protocolTimeout: 120_000,
});
console.log(JSON.stringify({ version: (await browser.version()).split('/')[1] }));
for (const task of JSON.parse(readFileSync(0, 'utf8'))) {
  const page = await browser.newPage();
  const said = [];
  page.on('console', (message) => said.push(message.text()));
  page.on('pageerror', (error) => said.push(String(error)));
  let answer;
  try {
    await page.setOfflineMode(true);
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'light' }]);
    const address = pathToFileURL(join(task.root, task.file)).href;
    await page.goto(address + (task.season ? `#${task.season}` : ''));
    // Either the page has drawn the tree, or it says below its title why not.
    await page.waitForFunction(() => document.documentElement.dataset.ready || document.querySelector('p')?.textContent, { timeout: 90_000 });
    answer = await page.evaluate(() => ({
      error: document.querySelector('p').textContent || undefined,
      buttons: [...document.querySelectorAll('button')].map((each) => each.textContent + (each.ariaPressed === 'true' ? '*' : '')),
    }));
    if (!answer.error) await page.screenshot({ path: task.shot });
  } catch (error) {
    answer = { error: String(error).split('\n')[0] };
  }
  await page.close().catch(() => {});
  console.log(JSON.stringify({ row: task.row, ...answer, said: said.slice(0, 8) }));
}
browser.process().kill('SIGKILL');
