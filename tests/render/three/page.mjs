// What runs in the page: a model in a scene with ground, sun and sky, drawn to a picture.

import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.toneMapping = THREE.NeutralToneMapping;
renderer.shadowMap.enabled = true;
renderer.shadowMap.type = THREE.PCFShadowMap;
document.body.append(renderer.domElement);

/** A camera that shows a plant whole from eye height, its foot or its leaves, as ../budgets.py stands its own. */
function stand(model, box, view) {
  const height = box.max.y;
  const toward = new THREE.Vector3(0.35, 0.1, 1).normalize();
  const reach = Math.max(height, 0.9 * Math.max(box.max.x - box.min.x, box.max.z - box.min.z));
  const [middle, size] = {
    whole: () => [new THREE.Vector3(0, height / 2, 0), 1.12 * reach],
    foot: () => [new THREE.Vector3(0, 1.1, 0), 3.2],
    leaves: () => [outermost(model, toward, height / 2), 1.2],
  }[view]();
  const angle = 2 * Math.atan(18 / 50);
  const camera = new THREE.PerspectiveCamera((angle * 180) / Math.PI, 1, size / 100, 1000 * reach);
  camera.position.copy(middle).addScaledVector(toward, (0.5 * size) / Math.tan(angle / 2));
  camera.lookAt(middle);
  return camera;
}

/** What stands out farthest to the camera at a height. */
function outermost(model, toward, height) {
  let [best, found] = [-Infinity, new THREE.Vector3()];
  const at = new THREE.Vector3();
  model.traverse((object) => {
    const positions = object.geometry?.attributes.position;
    for (let vertex = 0; vertex < (positions?.count ?? 0); vertex += 7) {
      at.fromBufferAttribute(positions, vertex).applyMatrix4(object.matrixWorld);
      const far = at.dot(toward) - 0.5 * Math.abs(at.y - height);
      if (far > best) [best, found] = [far, at.clone()];
    }
  });
  return found;
}

/** Draws the model at `url` and gives the picture as a data URL, with its triangles. */
window.shoot = async ({ url, size, view }) => {
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  const model = (await loader.loadAsync(url)).scene;
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xdfe8f2);
  const pmrem = new THREE.PMREMGenerator(renderer);
  scene.environment = pmrem.fromScene(new RoomEnvironment(), 0.04).texture;
  scene.environmentIntensity = 0.35;
  let triangles = 0;
  model.traverse((object) => {
    if (!object.isMesh) return;
    object.castShadow = object.receiveShadow = true;
    const drawn = (object.geometry.index ?? object.geometry.attributes.position).count / 3;
    triangles += drawn * (object.isInstancedMesh ? object.count : 1);
  });
  scene.add(model);
  model.updateMatrixWorld(true);
  const box = new THREE.Box3().setFromObject(model);
  const reach = box.getSize(new THREE.Vector3()).length();
  const sun = new THREE.DirectionalLight(0xfff4e0, 3);
  sun.position.set(0.8 * reach, 1.1 * reach, 0.9 * reach);
  sun.castShadow = true;
  sun.shadow.mapSize.set(4096, 4096);
  Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.01 * reach, far: 4 * reach });
  sun.shadow.normalBias = 0.002 * reach;
  scene.add(sun);
  const ground = new THREE.Mesh(new THREE.CircleGeometry(200 * reach, 64), new THREE.MeshStandardMaterial({ color: 0x877d66, roughness: 1 }));
  ground.rotation.x = -Math.PI / 2;
  ground.receiveShadow = true;
  scene.add(ground);
  renderer.setPixelRatio(2);
  renderer.setSize(size, size);
  renderer.render(scene, stand(model, box, view));
  const picture = renderer.domElement.toDataURL("image/png");
  pmrem.dispose();
  return { picture, triangles };
};

window.ready = true;
