// Plays a GLB by three.js and writes positions (m) and rotations (scalar last) of joints in space as
// doubles: node lossy_gltfpack.mjs FILE NODE_MODULES, with frames, seconds a frame and joints' names as
// JSON on standard input.
import { readFileSync, writeSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [file, modules] = process.argv.slice(2);
const own = (path) => import(pathToFileURL(`${modules}/three/${path}`));
const THREE = await own("build/three.module.js");
const { GLTFLoader } = await own("examples/jsm/loaders/GLTFLoader.js");
const { MeshoptDecoder } = await own("examples/jsm/libs/meshopt_decoder.module.js");
const { frames, step, names } = JSON.parse(readFileSync(0, "utf8"));

const bytes = readFileSync(file);
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const gltf = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "");
const found = new Map();
gltf.scene.traverse((node) => found.set(node.userData.name ?? node.name, node));
const joints = names.map((name) => found.get(name));
const mixer = new THREE.AnimationMixer(gltf.scene);
const action = mixer.clipAction(gltf.animations[0]).setLoop(THREE.LoopOnce);
action.clampWhenFinished = true;
action.play();

const numbers = new Float64Array(frames * joints.length * 7);
const [place, turn] = [new THREE.Vector3(), new THREE.Quaternion()];
let at = 0;
for (let frame = 0; frame < frames; frame++) {
  // At its end, an action that is done stays there.
  mixer.setTime(Math.min(frame * step, gltf.animations[0].duration - 1e-6));
  gltf.scene.updateMatrixWorld(true);
  for (const joint of joints) {
    joint.getWorldPosition(place).toArray(numbers, at);
    joint.getWorldQuaternion(turn).toArray(numbers, at + 3);
    at += 7;
  }
}
for (let left = new Uint8Array(numbers.buffer); left.length; ) left = left.subarray(writeSync(1, left));
