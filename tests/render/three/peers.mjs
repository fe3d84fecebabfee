// Writes trees of ez-tree as GLB, to stand beside linden's (`../budgets.py --peer`):
//
//     npm ci --prefix tests/render/three
//     node tests/render/three/peers.mjs FOLDER ["Oak Large" …]

import { mkdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { withPage } from "./browser.mjs";

const [folder, ...named] = process.argv.slice(2);
const presets = named.length ? named : ["Oak Large", "Ash Large", "Aspen Large", "Pine Large"];
await mkdir(folder, { recursive: true });
await withPage(new Map(), async (page) => {
  for (const preset of presets) {
    const glb = await page.evaluate(async (preset) => {
      const { Tree } = await import("./node_modules/@dgreenheck/ez-tree/build/ez-tree.es.js");
      const { GLTFExporter } = await import("three/addons/exporters/GLTFExporter.js");
      const tree = new Tree();
      tree.loadPreset(preset);
      tree.generate();
      const pictures = [];
      tree.traverse((object) => pictures.push(...[object.material ?? []].flat().flatMap((material) => [material.map, material.normalMap].filter(Boolean))));
      // Pictures are read from the library's own text: the exporter needs them whole.
      for (let tries = 0; tries < 200 && pictures.some((picture) => !picture.image?.complete); tries += 1)
        await new Promise((later) => setTimeout(later, 50));
      const bytes = new Uint8Array(await new GLTFExporter().parseAsync(tree, { binary: true }));
      let text = "";
      for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
      return btoa(text);
    }, preset);
    const file = path.join(folder, `ez-tree-${preset.toLowerCase().replaceAll(" ", "-")}.glb`);
    await writeFile(file, Buffer.from(glb, "base64"));
    console.log(file);
  }
});
