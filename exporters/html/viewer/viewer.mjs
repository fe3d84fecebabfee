// What runs in a page that linden writes: the tree within it, to be looked at from all sides. Bundled by bundle.sh.

import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const GROUNDS = { light: 0xe9ecef, dark: 0x15181a };

const canvas = document.querySelector("canvas");
const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
renderer.toneMapping = THREE.NeutralToneMapping;
renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));

const scene = new THREE.Scene();
const sky = new THREE.HemisphereLight(0xf4f7ff, 0x8a8272, 2.2);
const sun = new THREE.DirectionalLight(0xfff2dd, 2.6);
scene.add(sky, sun);
const camera = new THREE.PerspectiveCamera(35, 1, 0.01, 1000);
const controls = new OrbitControls(camera, canvas);
controls.enableDamping = true;
controls.autoRotateSpeed = 1.2;
const clock = new THREE.Timer();
let mixer = null;
let levels = [];

/** Bytes of base64 text. */
function bytes(text) {
  const binary = atob(text);
  return Uint8Array.from(binary, (letter) => letter.charCodeAt(0)).buffer;
}

/** Puts the camera where all is seen, from the side that previews show. */
function frame(box) {
  const [middle, size] = [box.getCenter(new THREE.Vector3()), box.getSize(new THREE.Vector3())];
  const wide = 0.5 * Math.max(size.x, size.z);
  const reach = Math.max(0.5 * size.y, wide / camera.aspect);
  // The near side of a crown looks larger than its middle.
  const far = (1.12 * reach) / Math.tan((camera.fov * Math.PI) / 360) + 0.5 * wide;
  const toward = new THREE.Vector3(0.495, 0.139, 0.858).normalize();
  camera.position.copy(middle).addScaledVector(toward, far);
  [camera.near, camera.far] = [far / 200, far * 20];
  camera.updateProjectionMatrix();
  controls.target.copy(middle);
  sun.position.copy(middle).add(new THREE.Vector3(0.8, 1.1, 0.9).multiplyScalar(size.length()));
  sun.target.position.copy(middle);
  scene.add(sun.target);
}

/** A button of the bar. */
function button(label, title, pressed, act) {
  const made = document.createElement("button");
  made.textContent = label;
  made.title = title;
  made.setAttribute("aria-pressed", pressed);
  made.onclick = () => act(made);
  document.querySelector("nav").append(made);
  return made;
}

function setDark(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  scene.background = new THREE.Color(dark ? GROUNDS.dark : GROUNDS.light);
}

/** Shows one of the levels of detail: nodes whose names end in _LOD0, _LOD1 and so on. */
function show(level) {
  for (const [number, node] of levels.flat()) node.visible = number === level;
}

function resize() {
  const [width, height] = [window.innerWidth, window.innerHeight];
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
}

async function start() {
  const told = window.matchMedia("(prefers-color-scheme: dark)");
  setDark(told.matches);
  told.addEventListener("change", () => setDark(told.matches));
  const text = document.getElementById("tree").textContent.trim();
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  const { scene: tree, animations } = await loader.parseAsync(bytes(text), "");
  scene.add(tree);
  tree.traverse((node) => {
    const found = /_LOD(\d+)(_\d+)?$/.exec(node.name);
    if (found && !node.parent?.name.match(/_LOD\d+$/)) levels.push([[Number(found[1]), node]]);
    // Leaves are lit from both sides.
    if (node.isMesh && node.material.side === THREE.DoubleSide) node.material.shadowSide = THREE.DoubleSide;
  });
  const most = Math.max(0, ...levels.flat().map(([number]) => number));
  show(0);
  resize();
  frame(new THREE.Box3().setFromObject(tree));
  button("Dark", "Dark or light", document.documentElement.dataset.theme === "dark", (made) => {
    const dark = document.documentElement.dataset.theme !== "dark";
    setDark(dark);
    made.setAttribute("aria-pressed", dark);
  });
  button("Turn", "Turn by itself", false, (made) => {
    controls.autoRotate = !controls.autoRotate;
    made.setAttribute("aria-pressed", controls.autoRotate);
  });
  if (animations.length > 0) {
    mixer = new THREE.AnimationMixer(tree);
    animations.forEach((clip) => mixer.clipAction(clip).play());
    button("Wind", "Wind", true, (made) => {
      mixer.timeScale = 1 - mixer.timeScale;
      made.setAttribute("aria-pressed", mixer.timeScale === 1);
    });
  }
  for (let level = 0; most > 0 && level <= most; level++) {
    button(`LOD${level}`, "Level of detail", level === 0, (made) => {
      show(level);
      document.querySelectorAll("nav button").forEach((other) => {
        if (other.textContent.startsWith("LOD")) other.setAttribute("aria-pressed", other === made);
      });
    });
  }
  window.addEventListener("resize", resize);
  renderer.setAnimationLoop(() => {
    clock.update();
    mixer?.update(clock.getDelta());
    controls.update();
    renderer.render(scene, camera);
    document.documentElement.dataset.ready = "true";
  });
}

start().catch((error) => {
  document.querySelector("p").textContent = `The tree cannot be shown: ${error.message}`;
});
