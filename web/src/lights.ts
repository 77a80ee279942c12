// Lights as the viewer makes them: new ones, and ones that become another kind, about as bright at the scene as those there are.
import type { Space } from "./handles.js";
import { withinView } from "./projection.js";
import type { Light, LightKind, LookAt, Vec3 } from "./protocol.js";
import { add, cross, length, scale, unit } from "./vectors.js";

const rounded = (a: Vec3): Vec3 => a.map((x) => Number(x.toPrecision(4))) as Vec3;

const distanceOf = (light: Light, space: Space): number => Math.max(1e-6, length(add(light.position ?? [0, 0, 0], space.center, -1)));
// Illuminance at the scene's middle, lux.
const lux = (light: Light, space: Space): number => (light.intensity ?? 1) / (light.kind === "directional" ? 1 : distanceOf(light, space) ** 2);

// Above the scene and a little to the side, as seen from the camera.
function perch(camera: LookAt, aspect: number, space: Space): Vec3 {
  const back = unit(add(camera.eye, camera.target, -1));
  const right = unit(cross(camera.up ?? [0, 1, 0], back));
  const way = unit(add(add(scale(right, 0.5), [0, 1, 0], 0.9), back, 0.35));
  return rounded(withinView(camera, aspect, space.center, way, 0.85 * space.radius));
}

function placed(kind: LightKind, position: Vec3, color: Vec3, brightness: number, space: Space): Light {
  const direction = rounded(unit(add(space.center, position, -1)));
  const light: Light = { kind, color };
  if (kind !== "directional") light.position = position;
  if (kind !== "point") light.direction = direction;
  if (kind === "spot") Object.assign(light, { inner: 20, outer: 40 });
  light.intensity = Number((brightness * (kind === "directional" ? 1 : distanceOf(light, space) ** 2)).toPrecision(3));
  return light;
}

export function newLight(kind: LightKind, camera: LookAt, aspect: number, space: Space, others: Light[]): Light {
  const brightest = Math.max(0, ...others.map((light) => lux(light, space)));
  return placed(kind, perch(camera, aspect, space), [1, 1, 1], brightest || 10, space);
}

export function asKind(light: Light, kind: LightKind, space: Space): Light {
  const position = light.position ?? rounded(add(space.center, unit(light.direction ?? [0, -1, 0]), -0.85 * space.radius));
  return placed(kind, position, light.color ?? [1, 1, 1], lux(light, space), space);
}
