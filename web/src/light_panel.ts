// The lights as a list of folders: kind, place, colour, strength, removal; and buttons that add one.
import type { Controller, GUI } from "lil-gui";
import { fromHex, toHex } from "./colour.js";
import { describe } from "./controls.js";
import type { Light, LightKind, Vec3 } from "./protocol.js";

export interface LightEvents {
  add(kind: LightKind): void;
  change(index: number, change: Partial<Light>): void;
  become(index: number, kind: LightKind): void;
  remove(index: number): void;
}

const KINDS: LightKind[] = ["point", "spot", "directional"];
const AXES = ["x", "y", "z"] as const;

interface NumberField {
  key: "intensity" | "radius" | "inner" | "outer" | "range";
  unit: (kind: LightKind) => string;
  help: string;
  kinds: LightKind[];
  initial: number;
  max?: number;
}

const FIELDS: NumberField[] = [
  { key: "intensity", unit: (kind) => (kind === "directional" ? "lux" : "candela"), help: "How strong; 0 or more", kinds: KINDS, initial: 1 },
  { key: "radius", unit: () => "scene units", help: "Of the emitting disc, for systems with soft shadows; 0: a point", kinds: KINDS, initial: 0 },
  { key: "inner", unit: () => "degrees", help: "Half angle of the cone of full strength; less than outer", kinds: ["spot"], initial: 0, max: 90 },
  { key: "outer", unit: () => "degrees", help: "Half angle at which the light ends; at most 90", kinds: ["spot"], initial: 45, max: 90 },
  { key: "range", unit: () => "scene units", help: "Where the light ends; 0: nowhere", kinds: ["point", "spot"], initial: 0 },
];

// Three significant digits of the scene's size are as fine as a hand can aim.
const stepFor = (radius: number): number => 10 ** Math.floor(Math.log10(Math.max(1e-9, radius)) - 2);

// As many digits as a field has room for.
const shown = (value: number): number => Number(value.toPrecision(4));

export class LightPanel {
  private folders: { gui: GUI; model: Record<string, unknown>; light: Light }[] = [];
  private readonly adders: GUI;
  private radius = 1;

  constructor(
    private readonly root: GUI,
    private readonly events: LightEvents,
  ) {
    this.adders = root.addFolder("Add a light").close();
    for (const kind of KINDS) {
      const add = { [kind]: () => events.add(kind) };
      describe(this.adders.add(add, kind).name(`${kind} light`), `add-${kind}`, `Adds a ${kind} light above what you look at`);
    }
  }

  // Rebuilds only where lights came, went or changed kind: fields that are being typed in stay.
  set(lights: Light[], radius: number): void {
    const same = lights.length === this.folders.length && radius === this.radius && lights.every((light, i) => light.kind === this.folders[i]!.light.kind);
    this.radius = radius;
    if (same) {
      lights.forEach((light, i) => this.refresh(i, light));
      return;
    }
    const open = this.folders.map((folder) => !folder.gui._closed);
    for (const { gui } of this.folders) gui.destroy();
    this.folders = lights.map((light, i) => this.build(light, i, open[i] ?? lights.length <= 2));
    this.root.$children.append(this.adders.domElement);
    this.root.title(lights.length === 1 ? "1 light" : `${lights.length} lights`);
  }

  refresh(index: number, light: Light): void {
    const folder = this.folders[index];
    if (!folder) return;
    Object.assign(folder.model, this.model(light));
    folder.light = light;
    // Not the field that has the keyboard: its text is being typed.
    for (const controller of folder.gui.controllers) if (!controller.domElement.contains(document.activeElement)) controller.updateDisplay();
  }

  private model(light: Light): Record<string, unknown> {
    const model: Record<string, unknown> = { kind: light.kind, color: toHex(light.color ?? [1, 1, 1]) };
    for (const field of FIELDS) model[field.key] = shown(light[field.key] ?? field.initial);
    for (const vector of ["position", "direction"] as const) AXES.forEach((axis, i) => (model[`${vector}-${axis}`] = shown(light[vector]?.[i] ?? 0)));
    return model;
  }

  private build(light: Light, index: number, open: boolean): { gui: GUI; model: Record<string, unknown>; light: Light } {
    const gui = this.root.addFolder(light.name ? `${index + 1} · ${light.name}` : `${index + 1} · ${light.kind}`);
    if (!open) gui.close();
    gui.domElement.dataset["light"] = String(index);
    const model = this.model(light);
    const id = (key: string): string => `light-${index}-${key}`;
    describe(gui.add(model, "kind", KINDS).onChange((kind: LightKind) => this.events.become(index, kind)), id("kind"), "What kind of light");
    if (light.kind !== "directional") this.vector(gui, model, "position", index, "Where the light is, scene units");
    if (light.kind !== "point") this.vector(gui, model, "direction", index, "The way the light travels; its length does not matter");
    describe(gui.addColor(model, "color").name("colour").onChange((hex: string) => this.events.change(index, { color: fromHex(hex) })), id("color"), "Colour of the light");
    for (const field of FIELDS.filter((f) => f.kinds.includes(light.kind))) this.number(gui, model, field, index);
    describe(gui.add({ remove: () => this.events.remove(index) }, "remove").name("Remove this light"), id("remove"), "Takes the light out of the view");
    return { gui, model, light };
  }

  private number(gui: GUI, model: Record<string, unknown>, field: NumberField, index: number): void {
    const kind = model["kind"] as LightKind;
    const controller: Controller = field.max === undefined ? gui.add(model, field.key).min(0) : gui.add(model, field.key, 0, field.max, 0.5);
    controller.onChange((value: number) => this.events.change(index, { [field.key]: value }));
    describe(controller.name(`${field.key} (${field.unit(kind)})`), `light-${index}-${field.key}`, field.help);
  }

  private vector(gui: GUI, model: Record<string, unknown>, key: "position" | "direction", index: number, help: string): void {
    for (const axis of AXES) {
      const controller = gui.add(model, `${key}-${axis}`).name(axis === "x" ? key : axis);
      controller.step(key === "position" ? stepFor(this.radius) : 0.01);
      controller.onChange(() => this.events.change(index, { [key]: AXES.map((a) => model[`${key}-${a}`]) as Vec3 }));
      describe(controller, `light-${index}-${key}-${axis}`, `${help} (${axis})`).domElement.classList.add("axis", axis);
    }
  }
}
