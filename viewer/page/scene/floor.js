import { Color, Group, Mesh, PlaneGeometry, ShaderMaterial, ShadowMaterial, Vector2 } from "three";

const SIZE = 40;

const VERTEX = `
varying vec2 place;
void main() {
  place = position.xz;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// Lines of one pixel's softness at any distance, fading out where the floor has no end.
const FRAGMENT = `
varying vec2 place;
uniform vec2 offset;
uniform float cell;
uniform vec3 colour;
uniform float strength;
uniform float far;
float lines(float size, float width) {
  vec2 at = (place + offset) / size;
  vec2 soft = fwidth(at);
  vec2 away = abs(fract(at - 0.5) - 0.5);
  vec2 line = 1.0 - smoothstep(soft * width, soft * (width + 1.0), away);
  line *= clamp(1.2 - 2.0 * soft, 0.0, 1.0); // far away, where lines would merge, none
  return max(line.x, line.y);
}
void main() {
  float fade = pow(clamp(1.0 - length(place) / far, 0.0, 1.0), 1.4);
  float line = max(0.4 * lines(cell, 0.1), 0.8 * lines(5.0 * cell, 0.35));
  gl_FragColor = vec4(colour, strength * fade * line);
}`;

/** The floor: a grid of whole units that stays where it is while the camera follows. */
export class Floor {
  /**
   * @param {number} cell side of a square, on the stage
   */
  constructor(cell) {
    const plane = new PlaneGeometry(SIZE, SIZE).rotateX(-Math.PI / 2);
    this.grid = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        offset: { value: new Vector2() },
        cell: { value: cell },
        colour: { value: new Color() },
        strength: { value: 1 },
        far: { value: 5 },
      },
      transparent: true,
      depthWrite: false,
    });
    this.shadow = new ShadowMaterial({ opacity: 0.25, depthWrite: false });
    const lines = new Mesh(plane, this.grid);
    const shade = new Mesh(plane, this.shadow);
    lines.renderOrder = -2;
    shade.renderOrder = -1;
    shade.receiveShadow = true;
    this.group = new Group().add(lines, shade);
    this.plane = plane;
  }

  /** Let the lines pass as if the floor had been moved there. */
  moveTo(x, z) {
    this.grid.uniforms.offset.value.set(x, z);
  }

  /** Show it as far as the motion goes. */
  reach(radius) {
    this.grid.uniforms.far.value = Math.min(SIZE / 2, Math.max(4.5, 1.3 * radius));
  }

  paint({ line, strength, shadow }) {
    this.grid.uniforms.colour.value.set(line).convertLinearToSRGB();
    this.grid.uniforms.strength.value = strength;
    this.shadow.opacity = shadow;
  }

  dispose() {
    this.plane.dispose();
    this.grid.dispose();
    this.shadow.dispose();
  }
}

/** A round number of the file's units, whose square is about half a metre of a person. */
export function gridUnit(scale) {
  const wanted = 0.5 / scale;
  const power = 10 ** Math.floor(Math.log10(wanted));
  return [1, 2, 5, 10].map((step) => step * power).find((unit) => unit >= 0.7 * wanted);
}
