import { DirectionalLight, Group, HemisphereLight, Scene, Vector3 } from "three";

import { Figure } from "./figure.js";
import { Floor, gridUnit } from "./floor.js";
import { Trail } from "./trail.js";

const MOMENTS = 50;

/** One scene: a floor, light, and the figures that stand on it. */
export class Stage {
  /**
   * @param {import("../state/take.js").Take[]} takes in one space; the first one's bearings count
   * @param {string[]} colours
   * @param {boolean} [compared] whether the second one is laid over the first
   */
  constructor(takes, colours, compared = false) {
    this.takes = takes;
    const { bearings } = takes[0];
    this.gridUnit = gridUnit(bearings.scale);
    this.scene = new Scene();
    this.world = new Group();
    this.floor = new Floor(this.gridUnit * bearings.scale);
    this.floor.reach(bearings.reach + 3);
    this.figures = takes.map((take, i) => new Figure(take, colours[i]));
    this.trails = takes.map(
      (take, i) => new Trail(take, this.figures[i].colour, 0.003 + 0.001 * i),
    );
    if (compared) this.figures[0].beShell(true);
    for (const part of [...this.figures, ...this.trails]) this.world.add(part.group);
    this.scene.add(this.floor.group, this.world, ...lights());
  }

  /** Whether the motion goes so far that a still camera would see a small figure. */
  get travels() {
    return this.reach > 1.4;
  }

  /** How far from its middle the motion goes. */
  get reach() {
    return this.takes[0].bearings.reach;
  }

  /** Show a moment; a camera that follows has the figures in the middle, one that stays their way. */
  show(time, follows) {
    this.takes.forEach((take, i) => {
      const frame = take.frameAt(time);
      this.figures[i].pose(frame);
      this.trails[i].moveTo(frame);
    });
    const [x, z] = follows ? this.#middle(time) : this.#centre;
    this.world.position.set(-x, 0, -z);
    this.floor.moveTo(x, z);
  }

  get #centre() {
    const [x, , z] = this.takes[0].bearings.centre;
    return [x, z];
  }

  /** The middle of the figures on their ways, on the floor. */
  #middle(time) {
    const places = this.takes.map((take) => take.wayAt(take.frameAt(time)));
    return [0, 1].map((k) => places.reduce((sum, place) => sum + place[k], 0) / places.length);
  }

  /** How far from their middle figures are at most, looking at some frames. */
  get spread() {
    if (this.takes.length < 2) return 0;
    const seconds = Math.max(...this.takes.map((take) => take.seconds));
    const times = Array.from({ length: MOMENTS }, (_, i) => (seconds * i) / MOMENTS);
    const away = (time) => {
      const [x, z] = this.#middle(time);
      return this.takes.map((take) => {
        const [a, b] = take.wayAt(take.frameAt(time));
        return Math.hypot(a - x, b - z);
      });
    };
    return Math.max(...times.flatMap(away));
  }

  /** The point that is nearest on the screen: {take, point, away in NDC}. */
  nearest(camera, x, y) {
    const place = new Vector3();
    const best = { take: null, point: -1, away: Infinity };
    for (const { take, places } of this.figures) {
      for (let point = take.root; point < take.points; point++) {
        place
          .fromArray(places, 3 * point)
          .add(this.world.position)
          .project(camera);
        const away = Math.hypot((place.x - x) * camera.aspect, place.y - y);
        if (away < best.away) Object.assign(best, { take, point, away });
      }
    }
    return best;
  }

  showTrails(visible) {
    for (const trail of this.trails) trail.group.visible = visible;
  }

  dispose() {
    for (const part of [this.floor, ...this.figures, ...this.trails]) part.dispose();
  }
}

function lights() {
  const sky = new HemisphereLight("#ffffff", "#8a94a6", 1.9);
  const sun = new DirectionalLight("#ffffff", 2.2);
  sun.position.set(2.5, 6, 3.5);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  sun.shadow.radius = 5;
  sun.shadow.bias = -0.0005;
  Object.assign(sun.shadow.camera, { left: -3, right: 3, top: 3, bottom: -3, near: 0.5, far: 14 });
  return [sky, sun];
}
