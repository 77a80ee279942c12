// What the picture shows, in the command line's words: for commands to copy, and for the address.
import type { CompareSettings, Light, LookAt, SnapshotSettings, Vec3 } from "./protocol.js";

export type Shown = Required<Pick<SnapshotSettings, "scene" | "size" | "camera" | "algorithm" | "show" | "exposure" | "ambient" | "tonemap" | "aa">> & { lights?: Light[] };

// What the program does when it is not told: server/common_options.c.
const DEFAULTS = { show: "shaded", exposure: "auto", ambient: 0.03, tonemap: "aces", aa: 1 } as const;
const FOV_DEFAULT = 45;
// The command line has no word for a scene without lights: it would add one.
const DARKNESS = "directional intensity=0";
const LIGHT_KEYS = ["position", "direction", "color", "intensity", "radius", "inner", "outer", "range"] as const;

export const inPoint = (a: Vec3): string => a.join(",");

export function lightInWords(light: Light): string {
  const pairs = LIGHT_KEYS.filter((key) => light[key] !== undefined).map((key) => `${key}=${String(light[key])}`);
  return [light.kind, ...pairs].join(" ");
}

// Undefined for what is none. The server says what is wrong with values.
export function lightFromWords(text: string): Light | undefined {
  const [kind, ...pairs] = text.trim().split(/\s+/);
  if (kind !== "point" && kind !== "spot" && kind !== "directional") return undefined;
  const light: Record<string, unknown> = { kind };
  for (const pair of pairs) {
    const [key = "", value = ""] = pair.split("=", 2);
    const numbers = value.split(",").map(Number);
    light[key] = numbers.length > 1 ? numbers : numbers[0];
  }
  return light as unknown as Light;
}

const quote = (text: string): string => (/^[\w./:=,@+-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`);
// A value that begins with a minus would be taken for an option.
const option = (name: string, value: string | number): string => `--${name}${/^-/.test(String(value)) ? "=" : " "}${quote(String(value))}`;

function cameraOptions(camera: LookAt | string | number): string[] {
  if (typeof camera !== "object") return [option("camera", camera)];
  const { eye, target, up, fov, height } = camera;
  const lens = height !== undefined ? [option("ortho", height)] : fov !== undefined && fov !== FOV_DEFAULT ? [option("fov", fov)] : [];
  const roll = up && inPoint(up) !== "0,1,0" ? [option("up", inPoint(up))] : [];
  return [option("eye", inPoint(eye)), option("target", inPoint(target)), ...roll, ...lens];
}

function viewOptions({ size, camera, lights, algorithm }: Shown): string[] {
  const words = lights?.map(lightInWords) ?? [];
  if (lights && words.length === 0) words.push(DARKNESS);
  return [option("size", size.join("x")), ...cameraOptions(camera), ...words.map((text) => option("light", text)), option("algorithm", algorithm)];
}

const fileName = (scene: string): string => scene.replace(/^builtin:/, "").replace(/^.*\//, "").replace(/\.\w+$/, "").replace(/[^\w.-]+/g, "-") || "picture";

// `server`: where the scene is known by its name; absent for scenes that every program has. What is not said is then as the server has it, so
// all is said.
export function renderCommand(shown: Shown, server?: string): string {
  const looks = (["show", "exposure", "ambient", "tonemap", "aa"] as const).filter((key) => server || shown[key] !== DEFAULTS[key]).map((key) => option(key, shown[key]));
  const from = server ? [option("server", server)] : [];
  return ["gnomon render", quote(shown.scene), ...from, "-o", quote(`${fileName(shown.scene)}.png`), ...viewOptions(shown), ...looks].join(" ");
}

export function compareCommand(shown: Shown, against: string): string {
  return ["gnomon compare", quote(shown.scene), ...viewOptions(shown), option("against", against), "-o", quote(`${fileName(shown.scene)}-error.png`), "--json -"].join(" ");
}

export function curlCommand(shown: Shown, server: string, guarded: boolean): string {
  const token = guarded ? ['-H "Authorization: Bearer $GNOMON_TOKEN"'] : [];
  return ["curl", ...token, "-d", quote(JSON.stringify({ ...shown, format: "png" })), quote(`${server}v1/render`), "-o", quote(`${fileName(shown.scene)}.png`)].join(" ");
}

export const comparable = ({ scene, size, camera, lights, algorithm }: Shown): CompareSettings => ({ scene, size, camera, algorithm, ...(lights && { lights }) });
