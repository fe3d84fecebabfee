// Draws glTF models with three.js in a headless Chromium:
//
//     npm ci --prefix tests/render/three
//     node tests/render/three/shoot.mjs [--size 400] [--view whole|foot|leaves] MODEL.glb=PICTURE.png …
//
// Prints for each picture a line: the picture, and the triangles that were drawn. A view counts for
// what follows it.

import { writeFile } from "node:fs/promises";
import path from "node:path";
import { withPage } from "./browser.mjs";

const shots = [];
let size = 400;
let view = "whole";
const words = process.argv.slice(2);
while (words.length) {
  const word = words.shift();
  if (word === "--size") size = Number(words.shift());
  else if (word === "--view") view = words.shift();
  else {
    const [model, picture] = word.split("=");
    shots.push({ model, picture, view });
  }
}
const files = new Map(shots.map(({ model }, index) => [`${index}${path.extname(model)}`, model]));
await withPage(files, async (page) => {
  for (const [index, { model, picture, view }] of shots.entries()) {
    const drawn = await page.evaluate((shot) => window.shoot(shot), { url: `/files/${index}${path.extname(model)}`, size, view });
    await writeFile(picture, Buffer.from(drawn.picture.split(",")[1], "base64"));
    console.log(`${picture} ${drawn.triangles}`);
  }
});
