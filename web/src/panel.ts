// The controls, made from what server.hello says there is.
import type { Algorithm, Hello, Param, SceneName } from "./protocol.js";

export interface PanelEvents {
  scene(name: string): void;
  algorithm(text: string): void;
  show(what: string): void;
}

function element<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Record<string, string> = {}, text = ""): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}

function row(label: string, control: HTMLElement, title = ""): HTMLElement {
  const made = element("label", { class: "row", title });
  made.append(element("span", {}, label), control);
  return made;
}

function select(id: string, values: string[], chosen: string, changed: (value: string) => void): HTMLSelectElement {
  const made = element("select", { id });
  for (const value of values) made.append(element("option", { value }, value));
  made.value = chosen;
  made.addEventListener("change", () => changed(made.value));
  return made;
}

function sceneSelect(scenes: SceneName[], chosen: string, changed: (value: string) => void): HTMLSelectElement {
  const made = element("select", { id: "scene" });
  for (const [source, label] of [["file", "Files"], ["builtin", "Built in"]] as const) {
    const group = element("optgroup", { label });
    for (const scene of scenes.filter((s) => s.source === source))
      group.append(element("option", { value: scene.name, title: scene.help ?? "" }, scene.name.replace(/^builtin:/, "")));
    if (group.childElementCount) made.append(group);
  }
  made.value = chosen;
  made.addEventListener("change", () => changed(made.value));
  return made;
}

// "sm:size=1024,slope=1" -> its name and parameters.
export function parseAlgorithm(text: string): { name: string; params: Map<string, string> } {
  const colon = text.indexOf(":");
  const name = colon < 0 ? text : text.slice(0, colon);
  const pairs = colon < 0 ? [] : text.slice(colon + 1).split(",").filter(Boolean);
  return { name, params: new Map(pairs.map((pair) => pair.split("=", 2) as [string, string])) };
}

function paramControl(param: Param, value: string, changed: () => void): HTMLInputElement | HTMLSelectElement {
  if (param.kind === "choice") return select(`param-${param.name}`, param.choices ?? [], value, changed);
  const input = element("input", { id: `param-${param.name}`, type: "number", step: param.kind === "float" ? "any" : param.odd ? "2" : "1" });
  if (param.min != null) input.min = String(param.min);
  if (param.max != null) input.max = String(param.max);
  input.value = value;
  input.addEventListener("change", changed);
  return input;
}

export class Panel {
  private readonly params = element("div", { id: "params" });
  private controls = new Map<string, HTMLInputElement | HTMLSelectElement>();
  private chosen: Algorithm | undefined;

  constructor(
    root: HTMLElement,
    private readonly hello: Hello,
    private readonly events: PanelEvents,
    current: { scene: string; algorithm: string; show: string },
  ) {
    const { name, params } = parseAlgorithm(current.algorithm);
    const algorithm = element("select", { id: "algorithm" });
    for (const a of hello.algorithms) algorithm.append(element("option", { value: a.name, title: a.help }, a.title));
    algorithm.value = name;
    algorithm.addEventListener("change", () => {
      this.choose(algorithm.value, new Map());
      this.tell();
    });
    root.replaceChildren(
      row("Scene", sceneSelect(hello.scenes, current.scene, events.scene)),
      row("Shadows", algorithm),
      this.params,
      row("Show", select("show", hello.capabilities.show, current.show, events.show)),
    );
    this.choose(name, params);
  }

  private choose(name: string, values: Map<string, string>): void {
    this.chosen = this.hello.algorithms.find((a) => a.name === name);
    this.controls = new Map();
    this.params.replaceChildren();
    for (const param of this.chosen?.params ?? []) {
      const control = paramControl(param, values.get(param.name) ?? String(param.default), () => this.tell());
      this.controls.set(param.name, control);
      this.params.append(row(param.unit ? `${param.name} (${param.unit})` : param.name, control, param.help));
    }
  }

  private tell(): void {
    if (!this.chosen) return;
    const pairs = [...this.controls].filter(([, control]) => control.value !== "").map(([name, control]) => `${name}=${control.value}`);
    this.events.algorithm(this.chosen.name + (pairs.length ? `:${pairs.join(",")}` : ""));
  }
}
