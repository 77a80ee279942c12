// A turntable about a target, up = +Y: what mouse, fingers and keys turn into a look-at.
import type { LookAt, Vec3 } from "./protocol.js";
import { add, cross, length } from "./vectors.js";

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

  // About the point at (x, y) from the picture's middle, fractions of its height: what lies there at the target's depth stays there.
  zoom(factor: number, x = 0, y = 0): void {
    const distance = Math.min(1e15, Math.max(1e-9, this.distance * factor));
    const kept = distance / this.distance;
    this.pan(x * (kept - 1), y * (kept - 1));
    this.distance = distance;
  }

  private arm(): Vec3 {
    const c = Math.cos(this.elevation);
    return [Math.sin(this.azimuth) * c, Math.sin(this.elevation), Math.cos(this.azimuth) * c];
  }
}
