import { Color, PerspectiveCamera, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD_OF_VIEW = 32;
const EYE = 0.92; // height at which the camera looks, of a figure 1.7 high
const [HALF_HEIGHT, HALF_WIDTH] = [1.12, 0.8]; // what has to be seen around a figure
const LOOKS = {
  dark: { line: "#aebbd0", strength: 0.5, shadow: 0.5, mark: new Color("#ffffff") },
  light: { line: "#42506a", strength: 0.5, shadow: 0.2, mark: new Color("#1b2433") },
};

/** The canvas: stages side by side, seen by one camera that the mouse or a finger moves. */
export class Viewport {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.stages = [];
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.setScissorTest(true);
    this.renderer.shadowMap.enabled = true;
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 120);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = 0.53 * Math.PI;
    this.controls.minDistance = 0.5;
    this.controls.maxDistance = 60;
    this.follows = false;
    this.theme = "light";
    this.dirty = true;
    this.controls.addEventListener("change", () => (this.dirty = true));
    new ResizeObserver(() => this.#resize()).observe(canvas);
  }

  /** @param {import("./stage.js").Stage[]} stages */
  show(stages) {
    for (const stage of this.stages) stage.dispose();
    this.stages = stages;
    this.setTheme(this.theme);
    this.follows = stages.some((stage) => stage.travels);
    this.#resize();
    this.frame();
  }

  /** @param {"dark"|"light"} theme */
  setTheme(theme) {
    this.theme = theme;
    for (const stage of this.stages) stage.floor.paint(LOOKS[theme]);
    this.dirty = true;
  }

  /** The colour of a chosen joint. */
  get mark() {
    return LOOKS[this.theme].mark;
  }

  /** Look at the whole from the front and a little from the side. */
  frame() {
    if (!this.stages.length) return;
    const reach = Math.max(...this.stages.map((stage) => (this.follows ? stage.spread : stage.reach)));
    const half = (FIELD_OF_VIEW / 2) * (Math.PI / 180);
    const across = Math.atan(Math.tan(half) * this.camera.aspect);
    const distance = Math.max(
      (HALF_HEIGHT + 0.4 * reach) / Math.sin(half),
      (HALF_WIDTH + reach) / Math.sin(across),
    );
    const angle = this.stages[0].takes[0].bearings.facing + 0.55;
    this.controls.target.set(0, EYE, 0);
    this.camera.position
      .set(Math.sin(angle), 0.26, Math.cos(angle))
      .normalize()
      .multiplyScalar(distance)
      .add(new Vector3(0, EYE, 0));
    this.controls.update();
    this.dirty = true;
  }

  /** Where the stages are on the canvas, in CSS pixels from its top left. */
  get cells() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const count = Math.max(1, this.stages.length);
    const columns = bestColumns(count, width, height);
    const rows = Math.ceil(count / columns);
    return this.stages.map((_, i) => ({
      x: ((i % columns) * width) / columns,
      y: (Math.floor(i / columns) * height) / rows,
      width: width / columns,
      height: height / rows,
    }));
  }

  /** The take and its point under a place on the canvas: {take, point}; null where there is none near. */
  pick(x, y) {
    const { cells } = this;
    const index = cells.findIndex(
      (cell) => x >= cell.x && x < cell.x + cell.width && y >= cell.y && y < cell.y + cell.height,
    );
    if (index < 0) return null;
    const cell = cells[index];
    const { take, point, away } = this.stages[index].nearest(
      this.camera,
      (2 * (x - cell.x)) / cell.width - 1,
      1 - (2 * (y - cell.y)) / cell.height,
    );
    return (away * cell.height) / 2 < 24 ? { take, point } : null;
  }

  /** Draw, if anything changed. */
  render() {
    this.controls.update();
    if (!this.dirty) return;
    this.dirty = false;
    const { renderer, canvas } = this;
    renderer.setScissor(0, 0, canvas.clientWidth, canvas.clientHeight);
    renderer.clear();
    this.cells.forEach((cell, i) => {
      const bottom = canvas.clientHeight - cell.y - cell.height;
      renderer.setViewport(cell.x, bottom, cell.width, cell.height);
      renderer.setScissor(cell.x, bottom, cell.width, cell.height);
      renderer.render(this.stages[i].scene, this.camera);
    });
    if (this.stages.length && !this.drawn) {
      this.drawn = true;
      performance.mark("first frame");
    }
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setSize(width, height, false);
    const [cell] = this.cells;
    this.camera.aspect = cell ? cell.width / cell.height : width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
    this.render(); // the canvas is empty until then
  }
}

/** As many columns as leave cells that are nearest to square, a little upright. */
function bestColumns(count, width, height) {
  let best = 1;
  let bestSize = 0;
  for (let columns = 1; columns <= count; columns++) {
    const rows = Math.ceil(count / columns);
    const size = Math.min(width / columns, (0.85 * height) / rows);
    if (size > bestSize) [best, bestSize] = [columns, size];
  }
  return best;
}
