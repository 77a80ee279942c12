// A turntable about a target, up = +Y: what mouse and fingers turn into a look-at.
import type { LookAt, Vec3 } from "./protocol.js";

const add = (a: Vec3, b: Vec3, s = 1): Vec3 => [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s];
const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a: Vec3): number => Math.hypot(a[0], a[1], a[2]);

const ELEVATION_MAX = Math.PI / 2 - 0.01; // up must not lie along the view

export class Orbit {
  private azimuth = 0;
  private elevation = 0;
  private distance = 1;
  private target: Vec3 = [0, 0, 0];
  private fov = 45;

  constructor(camera: LookAt) {
    const arm = add(camera.eye, camera.target, -1);
    this.target = [...camera.target];
    this.distance = length(arm);
    this.azimuth = Math.atan2(arm[0], arm[2]);
    this.elevation = Math.asin(Math.min(1, Math.max(-1, arm[1] / this.distance)));
    this.elevation = Math.min(ELEVATION_MAX, Math.max(-ELEVATION_MAX, this.elevation));
    this.fov = Math.min(170, Math.max(1, camera.fov ?? 45));
  }

  get camera(): LookAt {
    return { eye: add(this.target, this.arm(), this.distance), target: this.target, up: [0, 1, 0], fov: this.fov };
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
    const extent = 2 * this.distance * Math.tan((this.fov * Math.PI) / 360);
    this.target = add(add(this.target, right, -dx * extent), up, dy * extent);
  }

  zoom(factor: number): void {
    this.distance = Math.min(1e15, Math.max(1e-9, this.distance * factor));
  }

  private arm(): Vec3 {
    const c = Math.cos(this.elevation);
    return [Math.sin(this.azimuth) * c, Math.sin(this.elevation), Math.cos(this.azimuth) * c];
  }
}
