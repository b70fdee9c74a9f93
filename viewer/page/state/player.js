/** The clock of the page: plays, pauses, steps, at a speed; says when it changed. */
export class Player extends EventTarget {
  constructor() {
    super();
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.measure(1, 1);
  }

  /** Play this many frames of this many seconds each. */
  measure(frames, frameTime) {
    this.frames = frames;
    this.frameTime = frameTime;
    this.seek(0);
  }

  get frame() {
    return Math.min(this.frames - 1, Math.floor(this.time / this.frameTime + 1e-6));
  }

  play(playing = !this.playing) {
    if (playing && this.frame === this.frames - 1) this.time = 0;
    this.playing = playing && this.frames > 1;
    this.#changed();
  }

  /** Go to a frame and stay there. */
  step(frames) {
    this.playing = false;
    this.seek(this.frame + frames);
  }

  seek(frame) {
    const within = Math.min(this.frames - 1, Math.max(0, Math.round(frame)));
    this.time = within * this.frameTime;
    this.#changed();
  }

  setSpeed(speed) {
    this.speed = speed;
    this.#changed();
  }

  /** Let so many seconds of the world pass; at the end it begins again. */
  advance(seconds) {
    if (!this.playing) return;
    this.time = (this.time + seconds * this.speed) % (this.frames * this.frameTime);
    this.#changed();
  }

  #changed() {
    this.dispatchEvent(new Event("change"));
  }
}
