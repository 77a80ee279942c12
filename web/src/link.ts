// The address bar holds what is looked at, so that a link shows the same: #scene=...&algorithm=...&eye=...&light=...
import type { Light, LookAt, Vec3, ViewSettings } from "./protocol.js";
import { inPoint, lightFromWords, lightInWords } from "./words.js";

const TEXTS = ["scene", "algorithm", "show", "tonemap"] as const;
const NUMBERS = ["ambient", "aa"] as const;
const NO_LIGHTS = "none";
const WAIT_MS = 400; // browsers allow a page only so many addresses a second

const point = (text: string | null): Vec3 | undefined => {
  const numbers = (text ?? "").split(",").map(Number);
  return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as Vec3) : undefined;
};

function readCamera(given: URLSearchParams): ViewSettings["camera"] {
  const eye = point(given.get("eye")), target = point(given.get("target")), up = point(given.get("up"));
  const named = given.get("camera");
  if (!eye || !target) return named === null ? undefined : /^\d+$/.test(named) ? Number(named) : named;
  const camera: LookAt = { eye, target, ...(up && { up }) };
  if (given.has("ortho")) camera.height = Number(given.get("ortho"));
  else if (given.has("fov")) camera.fov = Number(given.get("fov"));
  return camera;
}

export function readLink(): ViewSettings {
  const given = new URLSearchParams(location.hash.slice(1));
  const settings: ViewSettings = {};
  for (const key of TEXTS) if (given.get(key)) settings[key] = given.get(key)!;
  for (const key of NUMBERS) if (given.get(key)) settings[key] = Number(given.get(key));
  const exposure = given.get("exposure"), camera = readCamera(given), lights = given.getAll("light");
  if (exposure) settings.exposure = exposure === "auto" ? exposure : Number(exposure);
  if (camera !== undefined) settings.camera = camera;
  if (lights.length > 0) settings.lights = lights.map(lightFromWords).filter((light): light is Light => light !== undefined);
  return settings;
}

function cameraPairs(camera: ViewSettings["camera"]): [string, string][] {
  if (camera === undefined) return [];
  if (typeof camera !== "object") return [["camera", String(camera)]];
  const { eye, target, up, fov, height } = camera;
  const pairs: [string, string][] = [["eye", inPoint(eye)], ["target", inPoint(target)]];
  if (up && inPoint(up) !== "0,1,0") pairs.push(["up", inPoint(up)]);
  pairs.push(height === undefined ? ["fov", String(fov ?? 45)] : ["ortho", String(height)]);
  return pairs;
}

function hashOf(settings: ViewSettings): string {
  const pairs: [string, string][] = TEXTS.filter((key) => settings[key]).map((key) => [key, settings[key]!]);
  for (const key of [...NUMBERS, "exposure"] as const) if (settings[key] !== undefined) pairs.push([key, String(settings[key])]);
  pairs.push(...cameraPairs(settings.camera));
  for (const light of settings.lights ?? []) pairs.push(["light", lightInWords(light)]);
  if (settings.lights?.length === 0) pairs.push(["light", NO_LIGHTS]);
  const plain = (text: string): string => encodeURIComponent(text).replace(/%20/g, "+").replace(/%(3A|2C|2F|3D)/g, decodeURIComponent);
  return `#${pairs.map(([key, value]) => `${key}=${plain(value)}`).join("&")}`;
}

export class Address {
  private timer: ReturnType<typeof setTimeout> | undefined;

  // At once; what was to be written soon is forgotten. Returns the whole address.
  write(settings: ViewSettings): string {
    clearTimeout(this.timer);
    this.timer = undefined;
    history.replaceState(null, "", `${location.pathname}${location.search}${hashOf(settings)}`);
    return location.href;
  }

  // For what changes with each movement of a hand.
  writeSoon(settings: () => ViewSettings): void {
    this.timer ??= setTimeout(() => this.write(settings()), WAIT_MS);
  }
}
