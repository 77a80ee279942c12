// Handles over the picture: one for each light, and one for what a spot is aimed at. Dragged in the plane parallel to the picture, with Shift
// along the view; focused, the arrow keys do the same.
import { eventUs, listenMoves } from "./gestures.js";
import { moveInView, project, withinView } from "./projection.js";
import type { Light, LookAt, Vec3 } from "./protocol.js";
import { add, dot, length, scale, unit } from "./vectors.js";

export interface HandleEvents {
  move(index: number, change: Partial<Light>, timeUs: number): void;
  end(index: number): void; // the hand let go
  remove(index: number): void;
}

export interface Space {
  center: Vec3;
  radius: number;
}

type Part = "place" | "aim";
interface Handle {
  index: number;
  part: Part;
  button: HTMLButtonElement;
  pulled: { x: number; y: number }; // from where it belongs, outside the picture, to where it is shown; pixels
}

const DIRECTIONAL_AT = 0.8; // of the scene's radius, at most
const KEY_STEP = 0.02; // of the picture's height
const EDGE = 14; // pixels from the border, for what lies outside
const TOP_EDGE = 66; // under the tools

// As fine as a hand can aim, and short in links and commands.
const short = (a: Vec3): Vec3 => a.map((x) => Number(x.toPrecision(6))) as Vec3;

const svg = <K extends keyof SVGElementTagNameMap>(tag: K): SVGElementTagNameMap[K] => document.createElementNS("http://www.w3.org/2000/svg", tag);

export class Handles {
  private handles: Handle[] = [];
  private lights: Light[] = [];
  private space: Space = { center: [0, 0, 0], radius: 1 };
  private camera: LookAt | undefined;
  private aspect = 1;
  private readonly lines = svg("svg");

  constructor(
    private readonly root: HTMLElement,
    private readonly events: HandleEvents,
  ) {
    this.lines.setAttribute("aria-hidden", "true");
    root.replaceChildren(this.lines);
  }

  set(lights: Light[], space: Space): void {
    const same = lights.length === this.lights.length && lights.every((light, i) => light.kind === this.lights[i]?.kind);
    this.lights = lights;
    this.space = space;
    if (!same) this.rebuild();
    this.place(this.camera);
  }

  place(camera: LookAt | undefined): void {
    this.camera = camera;
    const width = this.root.clientWidth, height = this.root.clientHeight;
    if (!camera || !width || !height) return;
    this.aspect = width / height;
    for (const handle of this.handles) {
      const spot = project(camera, width / height, this.at(handle));
      handle.button.hidden = !spot;
      if (!spot) continue;
      const outside = spot.x < 0 || spot.x > 1 || spot.y < 0 || spot.y > 1;
      const x = Math.min(width - EDGE, Math.max(EDGE, spot.x * width));
      const y = Math.min(height - EDGE, Math.max(outside ? TOP_EDGE : EDGE, spot.y * height));
      handle.pulled = outside ? { x: x - spot.x * width, y: y - spot.y * height } : { x: 0, y: 0 };
      handle.button.classList.toggle("outside", outside);
      handle.button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    }
    this.drawLines(camera, width, height);
  }

  private rebuild(): void {
    this.handles = this.lights.flatMap((light, index) => (light.kind === "spot" ? (["place", "aim"] as const) : (["place"] as const)).map((part) => this.make(index, part)));
    this.lines.replaceChildren(...this.lights.map(() => svg("line")));
    this.root.replaceChildren(this.lines, ...this.handles.map((handle) => handle.button));
  }

  private make(index: number, part: Part): Handle {
    const kind = this.lights[index]!.kind;
    const button = document.createElement("button");
    const what = part === "aim" ? `Aim of light ${index + 1}` : `Light ${index + 1} (${kind})`;
    button.className = `handle ${kind} ${part}`;
    button.type = "button";
    button.textContent = part === "aim" ? "" : String(index + 1);
    button.title = `${what}: drag to move, with Shift away and nearer; arrow keys do the same${part === "place" ? ", Delete removes it" : ""}`;
    button.setAttribute("aria-label", button.title);
    button.dataset["light"] = String(index);
    const handle: Handle = { index, part, button, pulled: { x: 0, y: 0 } };
    this.listen(handle);
    return handle;
  }

  private listen(handle: Handle): void {
    const { button } = handle;
    let last: { x: number; y: number } | undefined;
    button.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      button.setPointerCapture(event.pointerId);
      last = { x: event.clientX, y: event.clientY };
    });
    listenMoves(button, (event) => {
      if (!last) return;
      // One from outside comes in: it stays under the hand.
      const pulled = event.shiftKey ? { x: 0, y: 0 } : handle.pulled;
      const moved = event.clientX !== last.x || event.clientY !== last.y;
      const dx = (event.clientX - last.x + pulled.x) / this.root.clientHeight, dy = (event.clientY - last.y + pulled.y) / this.root.clientHeight;
      last = { x: event.clientX, y: event.clientY };
      if (moved) this.drag(handle, dx, dy, event.shiftKey, eventUs(event));
    });
    const lift = (): void => {
      if (last) this.events.end(handle.index);
      last = undefined;
    };
    button.addEventListener("pointerup", lift);
    button.addEventListener("pointercancel", lift);
    button.addEventListener("keydown", (event) => this.key(handle, event));
  }

  private key(handle: Handle, event: KeyboardEvent): void {
    const step = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] } as Record<string, [number, number]>)[event.key];
    const removes = handle.part === "place" && (event.key === "Delete" || event.key === "Backspace");
    if (!step && !removes) return;
    event.preventDefault();
    if (removes) this.events.remove(handle.index);
    if (!step) return;
    this.drag(handle, step[0] * KEY_STEP, step[1] * KEY_STEP, event.shiftKey, eventUs(event));
    this.events.end(handle.index);
  }

  // Where the handle stands in the scene.
  private at({ index, part }: Handle): Vec3 {
    const light = this.lights[index]!;
    const direction = unit(light.direction ?? [0, -1, 0]);
    if (light.kind === "directional") return withinView(this.camera!, this.aspect, this.space.center, scale(direction, -1), DIRECTIONAL_AT * this.space.radius);
    const position = light.position ?? [0, 0, 0];
    if (part === "place") return position;
    const toCenter = dot(add(this.space.center, position, -1), direction);
    return add(position, direction, Math.max(toCenter, 0.25 * this.space.radius));
  }

  private drag(handle: Handle, dx: number, dy: number, along: boolean, timeUs: number): void {
    if (!this.camera) return;
    const light = this.lights[handle.index]!;
    const from = this.at(handle);
    const to = along ? moveInView(this.camera, from, dx, 0, Math.exp(-2 * dy)) : moveInView(this.camera, from, dx, dy);
    const change = this.changeTo(light, handle.part, to);
    if (!change) return;
    Object.assign(light, change);
    this.place(this.camera);
    this.events.move(handle.index, change, timeUs);
  }

  private changeTo(light: Light, part: Part, to: Vec3): Partial<Light> | undefined {
    if (light.kind !== "directional" && part === "place") return { position: short(to) };
    const from = light.kind === "directional" ? to : (light.position ?? [0, 0, 0]);
    const ray = add(light.kind === "directional" ? this.space.center : to, from, -1);
    return length(ray) > 1e-9 * this.space.radius ? { direction: short(unit(ray)) } : undefined;
  }

  // From a spot to its aim, from a directional light to the scene's middle.
  private drawLines(camera: LookAt, width: number, height: number): void {
    this.lights.forEach((light, index) => {
      const line = this.lines.children[index] as SVGLineElement;
      const end = light.kind === "spot" ? this.at({ index, part: "aim" } as Handle) : this.space.center;
      const a = project(camera, width / height, this.at({ index, part: "place" } as Handle)), b = project(camera, width / height, end);
      const shown = light.kind !== "point" && a && b;
      line.style.display = shown ? "" : "none";
      if (!shown) return;
      for (const [name, value] of [["x1", a.x * width], ["y1", a.y * height], ["x2", b.x * width], ["y2", b.y * height]] as const) line.setAttribute(name, value.toFixed(1));
    });
  }
}
