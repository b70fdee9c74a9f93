import { DirectionalLight, Group, HemisphereLight, Scene, Vector3 } from "three";

import { Figure } from "./figure.js";
import { Floor, gridUnit } from "./floor.js";
import { Trail } from "./trail.js";

/** One scene: a floor, light, and the figures that stand on it. */
export class Stage {
  /**
   * @param {import("../state/take.js").Take[]} takes in one space; the first one's bearings count
   * @param {string[]} colours
   */
  constructor(takes, colours) {
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
    if (takes.length > 1) this.figures[0].beShell(true);
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

  /** Show a moment; a camera that follows has the figure in the middle, one that stays the way. */
  show(time, follows) {
    this.takes.forEach((take, i) => {
      const frame = take.frameAt(time);
      this.figures[i].pose(frame);
      this.trails[i].moveTo(frame);
    });
    const [first] = this.takes;
    const [x, z] = follows
      ? first.wayAt(first.frameAt(time))
      : [first.bearings.centre[0], first.bearings.centre[2]];
    this.world.position.set(-x, 0, -z);
    this.floor.moveTo(x, z);
  }

  /** The point of the first figure that is nearest on the screen: [point, distance in NDC]. */
  nearest(camera, x, y) {
    const place = new Vector3();
    const { places } = this.figures[0];
    let best = [-1, Infinity];
    for (let point = 0; point < this.takes[0].points; point++) {
      place
        .fromArray(places, 3 * point)
        .add(this.world.position)
        .project(camera);
      const away = Math.hypot((place.x - x) * camera.aspect, place.y - y);
      if (away < best[1]) best = [point, away];
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
