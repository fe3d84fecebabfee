// glTF-Transform and gltfpack: node transform.mjs MODULES transform|pack < tasks.json
// A file is read (by gltfpack: rewritten, then read), inspected and written again.
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, client] = process.argv.slice(2);
const { resolve } = createRequire(join(modules, 'x.js'));
const load = (name) => import(pathToFileURL(resolve(name)).href);
const { NodeIO, getBounds } = await load('@gltf-transform/core');
const { ALL_EXTENSIONS } = await load('@gltf-transform/extensions');
const { inspect } = await load('@gltf-transform/functions');
const { MeshoptDecoder, MeshoptEncoder } = await load('meshoptimizer');
await MeshoptDecoder.ready;
await MeshoptEncoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS)
  .registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'meshopt.encoder': MeshoptEncoder });

function facts(document) {
  const root = document.getRoot();
  const scene = root.getDefaultScene() ?? root.listScenes()[0];
  const told = { triangles: 0, lines: 0, morphs: 0, instances: 0, nodes: [], bodies: 0, cameras: 0, lights: 0, materials: {}, second: [] };
  const attributes = new Set();
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  const place = (m, [x, y, z]) => [0, 1, 2].map((i) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]);
  const turned = ([x, y, z, w], v) => {
    const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]];
  };
  scene.traverse((node) => {
    told.nodes.push(node.getName());
    told.cameras += node.getCamera() ? 1 : 0;
    told.lights += node.getExtension('KHR_lights_punctual') ? 1 : 0;
    const mesh = node.getMesh();
    if (!mesh) return;
    const many = node.getExtension('EXT_mesh_gpu_instancing');
    const column = (name) => many?.getAttribute(name);
    const times = many ? column('TRANSLATION').getCount() : 1;
    told.instances += many ? times : 0;
    const matrix = node.getWorldMatrix();
    for (const part of mesh.listPrimitives()) {
      const points = part.getAttribute('POSITION');
      if (part.getMode() !== 4) { told.lines += 1; continue; }
      told.triangles += (part.getIndices() ?? points).getCount() / 3 * times;
      told.morphs = Math.max(told.morphs, part.listTargets().length);
      const second = part.getAttribute('TEXCOORD_1');
      if (second) {
        const pairs = Array.from({ length: second.getCount() }, (_, i) => second.getElement(i, []));
        told.second.push({ vertices: points.getCount(), pairs, corners: [...(part.getIndices()?.getArray() ?? pairs.keys())] });
      }
      part.listSemantics().forEach((name) => attributes.add(name));
      for (let k = 0; k < times; k += 1) {
        for (let i = 0; i < points.getCount(); i += 1) {
          let at = points.getElement(i, []);
          if (many) {
            const [t, r, s] = ['TRANSLATION', 'ROTATION', 'SCALE'].map((name) => column(name)?.getElement(k, []));
            at = turned(r ?? [0, 0, 0, 1], at.map((x, j) => x * (s?.[j] ?? 1))).map((x, j) => x + t[j]);
          }
          place(matrix, at).forEach((x, j) => { low[j] = Math.min(low[j], x); high[j] = Math.max(high[j], x); });
        }
      }
      const material = part.getMaterial();
      if (material) {
        told.materials[material.getName()] = {
          picture: !!material.getBaseColorTexture()?.getSize()?.[0], normals: !!material.getNormalTexture()?.getSize()?.[0],
          cut: material.getAlphaMode() === 'MASK', two: material.getDoubleSided(), through: !!material.getExtension('KHR_materials_diffuse_transmission'),
        };
      }
    }
  });
  told.joints = Math.max(0, ...root.listSkins().map((skin) => skin.listJoints().length)) * root.listSkins().length;
  told.clips = root.listAnimations().map((clip) => [clip.getName(), 1, clip.listChannels().length]);
  told.attributes = [...attributes];
  told.box = told.joints ? null : [low, high];
  return told;
}

const packages = (name) => JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8')).version;
console.log(JSON.stringify({ version: packages(client === 'pack' ? 'gltfpack' : '@gltf-transform/core') }));
for (const task of JSON.parse(readFileSync(0, 'utf8'))) {
  let told;
  try {
    let file = join(task.root, task.file);
    if (client === 'pack') {
      const out = join(task.root, `${task.row}.pack.glb`);
      execFileSync(process.execPath, [join(modules, 'gltfpack/cli.js'), '-i', file, '-o', out, '-kn', '-km', '-ke', '-kv', '-noq'], { stdio: 'pipe' });
      file = out;
    }
    const document = await io.read(file);
    told = facts(document);
    const seen = inspect(document);
    told.inspected = seen.meshes.properties.length;
    if (client === 'pack') rmSync(file);
    else await io.readBinary(await io.writeBinary(document));
  } catch (error) {
    told = { error: (error.stderr?.toString().trim() || String(error)).slice(0, 300) };
  }
  console.log(JSON.stringify({ row: task.row, ...told }));
}
