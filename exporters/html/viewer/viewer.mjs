// What runs in a page that linden writes: the tree within it, to be looked at from all sides. Bundled by bundle.sh.

import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const GROUNDS = { light: 0xe9ecef, dark: 0x15181a };

const canvas = document.querySelector("canvas");
const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
renderer.toneMapping = THREE.NeutralToneMapping;
renderer.shadowMap.enabled = true;
renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));

const scene = new THREE.Scene();
const sky = new THREE.HemisphereLight(0xf4f7ff, 0x8a8272, 2.2);
const sun = new THREE.DirectionalLight(0xfff2dd, 2.6);
sun.castShadow = true;
sun.shadow.mapSize.set(2048, 2048);
scene.add(sky, sun);
const camera = new THREE.PerspectiveCamera(35, 1, 0.01, 1000);
const controls = new OrbitControls(camera, canvas);
controls.enableDamping = true;
controls.autoRotateSpeed = 1.2;
const clock = new THREE.Timer();
let mixer = null;
/** What is seen at some level of detail, or in some season: [node, level, season], null where it does not matter. */
const choices = [];
const chosen = { level: 0, season: null };

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
  const half = 0.55 * size.length();
  const view = sun.shadow.camera;
  [view.left, view.right, view.bottom, view.top, view.near, view.far] = [-half, half, -half, half, 0.1 * half, 6 * half];
  // As far as a leaf is long, so that none is its own shadow.
  sun.shadow.normalBias = 0.01 * half;
  sun.shadow.radius = 3;
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

/**
 * Leaves are lit from both sides. What is cut out covers as many samples of a pixel as its alpha says: a twig on a card is
 * finer than a pixel, and cut at one alpha it would come apart. From near edges are sharp.
 */
function dress(material) {
  for (const picture of [material.map, material.normalMap]) {
    if (picture) picture.anisotropy = renderer.capabilities.getMaxAnisotropy();
  }
  if (material.side === THREE.DoubleSide) material.shadowSide = THREE.DoubleSide;
  if (!(material.alphaTest > 0 && material.map)) return;
  material.alphaToCoverage = true;
  // Alpha chooses samples, and is not to be seen through.
  material.blending = THREE.CustomBlending;
  [material.blendSrc, material.blendDst] = [THREE.OneFactor, THREE.ZeroFactor];
  [material.blendSrcAlpha, material.blendDstAlpha] = [THREE.ZeroFactor, THREE.OneFactor];
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <alphatest_fragment>",
      `vec2 texels = fwidth(vMapUv * vec2(textureSize(map, 0)));
      float sharp = clamp((diffuseColor.a - alphaTest) / max(fwidth(diffuseColor.a), 1e-4) + 0.5, 0.0, 1.0);
      diffuseColor.a = mix(sharp, diffuseColor.a, clamp(max(texels.x, texels.y), 0.0, 1.0));
      if (diffuseColor.a < 0.05) discard;`,
    );
  };
}

/** Shows what was chosen. */
function show() {
  for (const [node, level, season] of choices) {
    node.visible = (level ?? chosen.level) === chosen.level && (season ?? chosen.season) === chosen.season;
  }
}

/** Buttons of which one is pressed: each is [label, value]. */
function choose(what, title, values) {
  const buttons = values.map(([label, value]) =>
    button(label, title, chosen[what] === value, (made) => {
      chosen[what] = value;
      show();
      for (const other of buttons) other.setAttribute("aria-pressed", other === made);
    }),
  );
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
    // Levels end in _LOD0, _LOD1 and so on; seasons are told by the nodes' extras.
    const found = /_LOD(\d+)(_\d+)?$/.exec(node.name);
    const level = found && !node.parent?.name.match(/_LOD\d+$/) ? Number(found[1]) : null;
    const season = node.userData.linden_season ?? null;
    if (level !== null || season !== null) choices.push([node, level, season]);
    if (!node.isMesh) return;
    [node.castShadow, node.receiveShadow] = [true, true];
    dress(node.material);
  });
  const most = Math.max(0, ...choices.map(([, level]) => level ?? 0));
  const seasons = [...new Set(choices.map(([, , season]) => season).filter((season) => season !== null))];
  // oak.html#autumn opens in autumn.
  const wanted = [decodeURIComponent(window.location.hash.slice(1)), "summer", seasons[0]];
  chosen.season = wanted.find((season) => seasons.includes(season)) ?? null;
  show();
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
  choose("season", "Season", seasons.map((season) => [season[0].toUpperCase() + season.slice(1), season]));
  const levels = Array.from({ length: most > 0 ? most + 1 : 0 }, (_, level) => [`LOD${level}`, level]);
  choose("level", "Level of detail", levels);
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
