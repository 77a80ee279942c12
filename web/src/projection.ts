// Where points of the scene lie in the picture, and how one camera's picture looks from another.
import type { LookAt, Vec3 } from "./protocol.js";
import { add, cross, dot, length, unit } from "./vectors.js";

export interface Spot {
  x: number; // fractions of the picture's width and height, from its upper left corner
  y: number;
  depth: number; // along the view, scene units
}

interface Axes {
  right: Vec3;
  up: Vec3;
  forward: Vec3;
  extent: (depth: number) => number; // height of what is seen there
}

function axes(camera: LookAt): Axes {
  const forward = unit(add(camera.target, camera.eye, -1));
  const right = unit(cross(forward, camera.up ?? [0, 1, 0]));
  const { height } = camera;
  const slope = 2 * Math.tan(((camera.fov ?? 45) * Math.PI) / 360);
  return { right, up: cross(right, forward), forward, extent: height === undefined ? (depth) => slope * depth : () => height };
}

// Undefined for what is not in front of the camera.
export function project(camera: LookAt, aspect: number, point: Vec3): Spot | undefined {
  const { right, up, forward, extent } = axes(camera);
  const ray = add(point, camera.eye, -1);
  const depth = dot(ray, forward);
  if (!(depth > 0)) return undefined;
  return { x: 0.5 + dot(ray, right) / (extent(depth) * aspect), y: 0.5 - dot(ray, up) / extent(depth), depth };
}

const MARGIN = 0.1; // of the picture

// As far from `center` along `way` as `most` allows while the point stays in the picture; at least a fifth of that.
export function withinView(camera: LookAt, aspect: number, center: Vec3, way: Vec3, most: number): Vec3 {
  for (let part = 1; part > 0.2; part -= 0.1) {
    const point = add(center, way, most * part);
    const spot = project(camera, aspect, point);
    if (spot && Math.max(Math.abs(spot.x - 0.5), Math.abs(spot.y - 0.5)) <= 0.5 - MARGIN) return point;
  }
  return add(center, way, most / 5);
}

// `point` moved in the plane parallel to the picture by fractions of the picture's height, and away from the eye by a factor of its depth.
export function moveInView(camera: LookAt, point: Vec3, dx: number, dy: number, away = 1): Vec3 {
  const { right, up, forward, extent } = axes(camera);
  const ray = add(point, camera.eye, -1);
  const depth = dot(ray, forward);
  const far = camera.height === undefined ? add(camera.eye, ray, away) : add(point, forward, (away - 1) * depth);
  return add(add(far, right, dx * extent(depth)), up, -dy * extent(depth));
}

function corners(camera: LookAt, aspect: number): Vec3[] {
  const { right, up, forward, extent } = axes(camera);
  const depth = length(add(camera.target, camera.eye, -1));
  const middle = add(camera.eye, forward, depth);
  const half = extent(depth) / 2;
  return ([[-1, 1], [1, 1], [1, -1], [-1, -1]] as const).map(([x, y]) => add(add(middle, right, x * half * aspect), up, y * half));
}

// The picture taken from `from`, as a card that stands at its target, seen from `to`: a CSS transform about the upper left corner of an element
// of width x height pixels. Right for pan and zoom at the target's depth, a guess for the rest. Undefined where a corner is behind the eye.
// The map from a square to a quadrangle: Heckbert, Fundamentals of Texture Mapping and Image Warping, 1989, section 2.2.3.
export function warp(from: LookAt, to: LookAt, width: number, height: number): string | undefined {
  const spots = corners(from, width / height).map((corner) => project(to, width / height, corner));
  const [p0, p1, p2, p3] = spots;
  if (!p0 || !p1 || !p2 || !p3) return undefined;
  const dx1 = p1.x - p2.x, dx2 = p3.x - p2.x, sx = p0.x - p1.x + p2.x - p3.x;
  const dy1 = p1.y - p2.y, dy2 = p3.y - p2.y, sy = p0.y - p1.y + p2.y - p3.y;
  const det = dx1 * dy2 - dx2 * dy1;
  if (!(Math.abs(det) > 1e-6)) return undefined;
  const g = (sx * dy2 - dx2 * sy) / det, h = (dx1 * sy - sx * dy1) / det;
  const a = p1.x - p0.x + g * p1.x, b = p3.x - p0.x + h * p3.x;
  const d = p1.y - p0.y + g * p1.y, e = p3.y - p0.y + h * p3.y;
  const ratio = height / width;
  const columns = [a, d * ratio, 0, g / width, b / ratio, e, 0, h / height, 0, 0, 1, 0, p0.x * width, p0.y * height, 0, 1];
  return `matrix3d(${columns.map((n) => n.toPrecision(9)).join(",")})`;
}
