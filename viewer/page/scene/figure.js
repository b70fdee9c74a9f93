import {
  Color,
  CylinderGeometry,
  Group,
  InstancedMesh,
  Matrix4,
  MeshStandardMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";

const UP = new Vector3(0, 1, 0);
const THINNEST = 0.007;
const THICKEST = 0.026;
const CHOSEN_BALL = 0.03;
const [MARKER_BALL, MISSING_BALL, MARKER_BONE] = [0.016, 0.009, 0.005];
const [SMALL_HEAD, LARGE_HEAD] = [0.06, 0.1];

/**
 * A skeleton on a stage: tapered bones from joint to joint, balls at the joints, a head. Or markers:
 * balls, and thin bones where they are known; a marker that is missing is a small ball where it was.
 */
export class Figure {
  /**
   * @param {import("../state/take.js").Take} take
   * @param {string} colour
   */
  constructor(take, colour) {
    this.take = take;
    this.colour = new Color(colour);
    this.group = new Group();
    this.places = new Float32Array(3 * take.points);
    this.material = new MeshStandardMaterial({ roughness: 0.55, metalness: 0.05 });
    const cylinder = new CylinderGeometry(0.62, 1, 1, 14, 1, true).translate(0, 0.5, 0);
    this.boneMesh = this.#mesh(cylinder, Math.max(1, take.bones.length));
    this.boneMesh.count = take.bones.length;
    this.ballMesh = this.#mesh(new SphereGeometry(1, 18, 12), Math.max(1, take.points));
    this.headMesh = this.#mesh(new SphereGeometry(1, 24, 18), 1);
    this.#measure();
    this.paint(null);
  }

  /** Draw it as a shell of glass, around another figure. */
  beShell(shell) {
    this.grown = shell ? 1.5 : 1;
    this.material.transparent = shell;
    this.material.opacity = shell ? 0.26 : 1;
    this.material.needsUpdate = true;
  }

  /** Take the pose of a frame. */
  pose(frame) {
    const { take, places } = this;
    for (let point = 0; point < take.points; point++) take.onStage(frame, point, places, 3 * point);
    const matrix = new Matrix4();
    const turn = new Quaternion();
    const [from, to, size] = [new Vector3(), new Vector3(), new Vector3()];
    take.bones.forEach(([parent, point], i) => {
      from.fromArray(places, 3 * parent);
      to.fromArray(places, 3 * point).sub(from);
      const cut = take.isMissing(frame, parent) || take.isMissing(frame, point);
      const length = cut ? 0 : to.length();
      const radius = this.grown * this.thickness[i];
      turn.setFromUnitVectors(UP, length > 0 ? to.divideScalar(length) : UP);
      size.set(radius, length, radius);
      this.boneMesh.setMatrixAt(
        i,
        matrix.compose(from, turn, length > 0 ? size : size.setScalar(0)),
      );
      if (point !== this.headEnd) return;
      const head = this.grown ** 0.3 * Math.min(LARGE_HEAD, Math.max(SMALL_HEAD, 0.55 * length));
      from.addScaledVector(to, length / 2);
      this.headMesh.setMatrixAt(
        0,
        matrix.compose(from, turn, size.set(0.82 * head, head, 0.9 * head)),
      );
    });
    turn.identity();
    for (let point = 0; point < take.points; point++) {
      let usual = take.isMissing(frame, point) ? MISSING_BALL : this.balls[point];
      if (take.isGone(frame, point)) usual = 0;
      const isChosen = point === this.chosen && point >= take.root;
      const radius = this.grown * (isChosen ? CHOSEN_BALL : usual);
      from.fromArray(places, 3 * point);
      this.ballMesh.setMatrixAt(point, matrix.compose(from, turn, size.setScalar(radius)));
    }
    for (const mesh of this.#meshes) mesh.instanceMatrix.needsUpdate = true;
  }

  /**
   * Colour every point; null gives the figure's own colour.
   *
   * @param {((point: number, colour: Color) => void)|null} paint changes the colour it is given
   * @param {number} [chosen] joint whose bones are marked
   * @param {Color} [mark] in this colour
   */
  paint(paint, chosen = -1, mark = this.colour) {
    const { bones, parents } = this.take;
    this.chosen = chosen;
    const colour = new Color();
    const of = (point, joint) => {
      colour.copy(this.colour);
      paint?.(point, colour);
      return joint === chosen ? colour.copy(mark) : colour;
    };
    bones.forEach(([parent, point], i) => this.boneMesh.setColorAt(i, of(point, parent)));
    parents.forEach((_, point) => this.ballMesh.setColorAt(point, of(point, point)));
    if (this.headEnd >= 0) this.headMesh.setColorAt(0, of(this.headEnd, parents[this.headEnd]));
    for (const mesh of this.#meshes) if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
  }

  dispose() {
    for (const mesh of this.#meshes) {
      mesh.geometry.dispose();
      mesh.dispose();
    }
    this.material.dispose();
  }

  get #meshes() {
    return [this.boneMesh, this.ballMesh, this.headMesh];
  }

  #mesh(geometry, count) {
    const mesh = new InstancedMesh(geometry, this.material, count);
    mesh.castShadow = true;
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  /** Long bones are thicker than short ones; a ball covers the bones that meet in it. */
  #measure() {
    const { take } = this;
    this.grown = 1;
    this.thickness = new Float32Array(take.bones.length).fill(MARKER_BONE);
    this.balls = new Float32Array(take.points).fill(take.clip.markers ? MARKER_BALL : THINNEST);
    const [from, to] = [new Vector3(), new Vector3()];
    const place = [0, 0, 0];
    const isHead = (point) => /head$/i.test(take.jointNames[take.parents[point]] ?? "");
    this.headEnd = take.bones.find(([, point]) => isHead(point))?.[1] ?? -1;
    this.headMesh.visible = this.headEnd >= 0;
    if (take.clip.markers) return;
    this.balls.fill(0, 0, take.root);
    take.bones.forEach(([parent, point], i) => {
      take.onStage(0, parent, place);
      from.fromArray(place);
      take.onStage(0, point, place);
      const length = from.distanceTo(to.fromArray(place));
      const radius = Math.min(THICKEST, Math.max(THINNEST, 0.1 * length));
      this.thickness[i] = radius;
      this.balls[parent] = Math.max(this.balls[parent], 1.12 * radius);
      this.balls[point] = Math.max(this.balls[point], 0.74 * radius);
    });
    if (this.headEnd >= 0) this.balls[this.headEnd] = 0;
  }
}
