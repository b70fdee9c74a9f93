import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial } from "three";

const MOST_POINTS = 4000;
const HALF_WIDTH = 0.009;

/** The way of the root over the floor: what has been, and, fainter, what is to come. */
export class Trail {
  /**
   * @param {import("../state/take.js").Take} take
   * @param {import("three").Color} colour
   * @param {number} height above the floor, so that trails do not fight each other
   */
  constructor(take, colour, height) {
    this.step = Math.max(1, Math.ceil(take.frames / MOST_POINTS));
    this.count = Math.floor((take.frames - 1) / this.step) + 1;
    this.geometries = [];
    this.materials = [];
    this.group = new Group();
    const strip = ribbon(take, this.step, this.count, height);
    for (const opacity of [0.22, 0.75]) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", strip.places);
      geometry.setIndex(strip.index);
      const material = new MeshBasicMaterial({
        color: colour,
        opacity,
        transparent: true,
        depthWrite: false,
        side: DoubleSide,
      });
      const mesh = new Mesh(geometry, material);
      mesh.frustumCulled = false;
      this.geometries.push(geometry);
      this.materials.push(material);
      this.group.add(mesh);
    }
  }

  moveTo(frame) {
    this.geometries[1].setDrawRange(0, 6 * Math.min(this.count - 1, Math.round(frame / this.step)));
  }

  dispose() {
    for (const part of [...this.geometries, ...this.materials]) part.dispose();
  }
}

function ribbon(take, step, count, height) {
  const way = new Float32Array(2 * count);
  const here = [0, 0, 0];
  for (let i = 0; i < count; i++) {
    take.rootOnStage(i * step, here);
    way[2 * i] = here[0];
    way[2 * i + 1] = here[2];
  }
  const places = new Float32Array(6 * count);
  let [across, along] = [HALF_WIDTH, 0]; // kept while the root stands still
  for (let i = 0; i < count; i++) {
    const [before, after] = [Math.max(0, i - 1), Math.min(count - 1, i + 1)];
    const dx = way[2 * after] - way[2 * before];
    const dz = way[2 * after + 1] - way[2 * before + 1];
    const length = Math.hypot(dx, dz);
    if (length > 1e-5) [across, along] = [(-dz / length) * HALF_WIDTH, (dx / length) * HALF_WIDTH];
    places.set(
      [
        way[2 * i] + across,
        height,
        way[2 * i + 1] + along,
        way[2 * i] - across,
        height,
        way[2 * i + 1] - along,
      ],
      6 * i,
    );
  }
  const index = new Uint32Array(6 * Math.max(0, count - 1));
  for (let i = 0; i < count - 1; i++) {
    const k = 2 * i;
    index.set([k, k + 1, k + 2, k + 1, k + 3, k + 2], 6 * i);
  }
  return { places: new BufferAttribute(places, 3), index: new BufferAttribute(index, 1) };
}
