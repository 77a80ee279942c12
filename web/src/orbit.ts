// A turntable about a target, up = +Y: what mouse, fingers and keys turn into a look-at.
import type { LookAt, Vec3 } from "./protocol.js";
import { add, cross, length } from "./vectors.js";

const LEAST = 1e-9; // distance of the target, or height of an orthographic picture: what the wire takes
const MOST = 1e15;
const ELEVATION_MAX = Math.PI / 2 - 0.01; // up must not lie along the view

export class Orbit {
  private azimuth = 0;
  private elevation = 0;
  private distance = 1;
  private target: Vec3 = [0, 0, 0];
  private fov = 45;
  private height: number | undefined; // orthographic

  constructor(camera: LookAt) {
    const arm = add(camera.eye, camera.target, -1);
    this.target = [...camera.target];
    this.distance = length(arm);
    this.azimuth = Math.atan2(arm[0], arm[2]);
    this.elevation = Math.asin(Math.min(1, Math.max(-1, arm[1] / this.distance)));
    this.elevation = Math.min(ELEVATION_MAX, Math.max(-ELEVATION_MAX, this.elevation));
    this.fov = Math.min(170, Math.max(1, camera.fov ?? 45));
    this.height = camera.height;
  }

  // A parallel camera has to stand before what it turns about; how far does not show.
  standOff(distance: number): void {
    if (this.height !== undefined) this.distance = Math.max(this.distance, distance);
  }

  // Rounded to a millionth of the distance, far below a pixel: short numbers for links and commands, and exactly what they show.
  get camera(): LookAt {
    const seen = Math.min(this.distance, this.height ?? Infinity);
    const places = Math.min(100, Math.max(0, 6 - Math.floor(Math.log10(seen))));
    const rounded = (a: Vec3): Vec3 => a.map((x) => Number(x.toFixed(places))) as Vec3;
    const place = { eye: rounded(add(this.target, this.arm(), this.distance)), target: rounded(this.target), up: [0, 1, 0] as Vec3 };
    return this.height === undefined ? { ...place, fov: Number(this.fov.toPrecision(6)) } : { ...place, height: Number(this.height.toPrecision(6)) };
  }

  // Fractions of the picture's height.
  turn(dx: number, dy: number): void {
    this.azimuth -= dx * Math.PI;
    this.elevation = Math.min(ELEVATION_MAX, Math.max(-ELEVATION_MAX, this.elevation + dy * Math.PI));
  }

  pan(dx: number, dy: number): void {
    const back = this.arm();
    const right: Vec3 = [Math.cos(this.azimuth), 0, -Math.sin(this.azimuth)];
    const up = cross(back, right);
    const extent = this.height ?? 2 * this.distance * Math.tan((this.fov * Math.PI) / 360);
    this.target = add(add(this.target, right, -dx * extent), up, dy * extent);
  }

  // About the point at (x, y) from the picture's middle, fractions of its height: what lies there at the target's depth stays there.
  zoom(factor: number, x = 0, y = 0): void {
    const before = this.height ?? this.distance;
    const after = Math.min(MOST, Math.max(LEAST, before * factor));
    this.pan(x * (after / before - 1), y * (after / before - 1));
    if (this.height === undefined) this.distance = after;
    else this.height = after;
  }

  private arm(): Vec3 {
    const c = Math.cos(this.elevation);
    return [Math.sin(this.azimuth) * c, Math.sin(this.elevation), Math.cos(this.azimuth) * c];
  }
}
