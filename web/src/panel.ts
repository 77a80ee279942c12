// The controls, made from what server.hello says there is: no scene and no shadow system is known here by name.
import { type Controller, GUI } from "lil-gui";
import { type Described, joinSettings, readValues, splitSettings, type Values } from "./algorithm.js";
import { type CompareEvents, ComparePanel } from "./compare_panel.js";
import { addParam, describe } from "./controls.js";
import { type LightEvents, LightPanel } from "./light_panel.js";
import type { Algorithm, Hello, SceneInfo, SceneName, ViewInfo, ViewSettings } from "./protocol.js";

export interface PanelEvents {
  scene(name: string): void;
  camera(choice: string | number): void;
  set(settings: ViewSettings): void;
  sharpness(scale: number): void;
  snapshot(settings: Snapshot): void;
  share(what: Shared): void;
  lights: LightEvents;
  compare: CompareEvents;
}

export type Shared = "link" | "render" | "compare" | "curl";

export interface Snapshot {
  width: number;
  height: number;
  format: string;
  aa: number;
  quality?: number;
}

const TONEMAPS = ["aces", "none"];
const SAMPLES = [1, 4, 16];
const AMBIENT_DEFAULT = 0.03; // the program's own, where view.open does not tell
const OWN_CAMERA = "(moved)";
const SHARPNESS = { "full, 1:1": 1, "three quarters": 0.75, half: 0.5 };

const withoutName = (scenes: SceneName[], text: string): SceneName | undefined =>
  scenes.find((s) => s.name === text) ?? scenes.find((s) => s.source === "builtin" && text.startsWith(`${s.name}:`));

export class Panel {
  readonly lights: LightPanel;
  readonly compare: ComparePanel;
  private readonly gui: GUI;
  private readonly shadows: GUI;
  private readonly sceneFolder: GUI;
  private readonly choice: { scene: string; camera: string; algorithm: string; show: string };
  homeCamera: string | number = "auto";
  private camera: Controller | undefined;
  private shown: Controller | undefined;
  private params: Controller[] = [];
  private built = ""; // the system that `params` are of
  private sceneParams: Controller[] = [];

  constructor(
    root: HTMLElement,
    readonly hello: Hello,
    private readonly events: PanelEvents,
    view: ViewInfo,
  ) {
    root.replaceChildren();
    this.gui = new GUI({ container: root, injectStyles: false, title: "Controls" });
    this.gui.$title.remove(); // the page has its own way to hide the panel
    this.choice = { scene: view.scene, camera: "0", algorithm: "", show: view.show };
    this.sceneFolder = this.gui.addFolder("Scene");
    this.shadows = this.gui.addFolder("Shadows");
    this.compare = new ComparePanel(this.gui.addFolder("Error").close(), hello, events.compare);
    this.lights = new LightPanel(this.gui.addFolder("Lights"), events.lights);
    this.buildScenes(view.scene);
    this.buildShadows(view.algorithm);
    this.buildPicture(view);
    this.buildStream(view);
    this.buildSnapshot();
    this.buildShare();
  }

  // After a scene was opened with `camera`; absent: its first.
  describeScene(info: SceneInfo, camera: ViewSettings["camera"]): void {
    const options: Record<string, string> = { "frames the scene": "auto" };
    info.cameras.forEach((camera, i) => (options[`${i} ${camera.name ?? camera.kind}`] = String(i)));
    options[OWN_CAMERA] = OWN_CAMERA;
    this.homeCamera = info.cameras.length ? 0 : "auto";
    this.choice.camera = typeof camera === "object" ? OWN_CAMERA : String(camera ?? this.homeCamera);
    const changed = (value: string): void => {
      if (value !== OWN_CAMERA) this.events.camera(value === "auto" ? value : Number(value));
    };
    const fresh = this.camera ? this.camera.options(options) : this.sceneFolder.add(this.choice, "camera", options);
    this.camera = describe(fresh.onChange(changed), "camera", "Where to look from: the scene's own cameras, or one that frames it");
    this.camera.updateDisplay();
    const count = (n: number): string => n.toLocaleString("en");
    this.sceneFolder.$title.title = `${count(info.triangles)} triangles (${count(info.drawn_triangles)} drawn), ${count(info.vertices)} vertices`;
  }

  // Undefined: moved by hand.
  cameraIs(choice: string | number | undefined): void {
    const text = choice === undefined ? OWN_CAMERA : String(choice);
    if (this.choice.camera === text) return;
    this.choice.camera = text;
    this.camera?.updateDisplay();
  }

  // The view as the server has it: what it refused goes back.
  sync(view: ViewInfo): void {
    this.choice.show = view.show;
    this.shown?.updateDisplay();
    this.syncScene(view.scene);
    this.buildShadows(view.algorithm);
  }

  nextAlgorithm(step: number): void {
    const { algorithms } = this.hello;
    const at = algorithms.findIndex((a) => a.name === this.choice.algorithm);
    const next = algorithms[(at + step + algorithms.length) % algorithms.length];
    if (next) this.events.set({ algorithm: next.name });
  }

  nextShow(): void {
    const { show } = this.hello.capabilities;
    this.events.set({ show: show[(show.indexOf(this.choice.show) + 1) % show.length]! });
  }

  private buildScenes(current: string): void {
    const { scenes } = this.hello;
    const scene = withoutName(scenes, current);
    this.choice.scene = scene?.name ?? current;
    const options: Record<string, string> = {};
    for (const s of scenes) options[s.source === "file" ? s.name : `${s.name.replace(/^builtin:/, "")} (built in)`] = s.name;
    if (!scene) options[current] = current;
    const help = (): string => withoutName(scenes, this.choice.scene)?.help ?? "A scene of the server";
    const control = this.sceneFolder.add(this.choice, "scene", options).onChange((name: string) => {
      describe(control, "scene", help());
      this.buildSceneParams(withoutName(scenes, name), name);
      this.events.scene(name);
    });
    describe(control, "scene", help());
    this.buildSceneParams(scene, current);
  }

  private syncScene(text: string): void {
    const scene = withoutName(this.hello.scenes, text);
    if (!scene || scene.name === this.choice.scene) return;
    this.choice.scene = scene.name;
    this.sceneFolder.controllers[0]?.updateDisplay();
    this.buildSceneParams(scene, text);
  }

  private buildSceneParams(scene: SceneName | undefined, text: string): void {
    for (const controller of this.sceneParams) controller.destroy();
    const params = scene?.params ?? [];
    const given = scene ? splitSettings(`x${text.slice(scene.name.length)}`).values : new Map<string, string>();
    const values = readValues(params, given);
    this.sceneParams = params.map((param) =>
      addParam(this.sceneFolder, values, param).onFinishChange(() => this.events.scene(joinSettings(scene!.name, params, values))),
    );
    if (this.camera) this.sceneFolder.$children.append(this.camera.domElement);
  }

  private buildShadows(text: string): void {
    const { name, values: given } = splitSettings(text);
    const algorithm = this.hello.algorithms.find((a) => a.name === name);
    const params: Described[] = algorithm?.params ?? [];
    const values = readValues(params, given);
    if (name !== this.built) this.rebuildShadows(name, algorithm, values);
    else this.params.forEach((controller, i) => this.refresh(controller, values[params[i]!.name]!));
  }

  private refresh(controller: Controller, value: number | string): void {
    (controller.object as Values)[controller.property] = value;
    if (!controller.domElement.contains(document.activeElement) || document.activeElement instanceof HTMLSelectElement) controller.updateDisplay();
  }

  private rebuildShadows(name: string, algorithm: Algorithm | undefined, values: Values): void {
    const focused = this.shadows.domElement.contains(document.activeElement) && document.activeElement instanceof HTMLSelectElement;
    for (const controller of [...this.shadows.controllers]) controller.destroy();
    this.choice.algorithm = this.built = name;
    const options = Object.fromEntries(this.hello.algorithms.map((a) => [a.title, a.name]));
    const system = this.shadows.add(this.choice, "algorithm", options).name("system");
    system.onChange((chosen: string) => this.events.set({ algorithm: chosen }));
    describe(system, "algorithm", algorithm ? `${algorithm.help} (${algorithm.name}; lights: ${algorithm.lights.join(", ")})` : "The shadow system");
    const params = algorithm?.params ?? [];
    const send = (): void => this.events.set({ algorithm: joinSettings(name, params, values) });
    this.params = params.map((param) => addParam(this.shadows, values, param).onChange(send));
    if (focused) system.domElement.querySelector("select")?.focus();
  }

  private buildPicture(view: ViewInfo): void {
    const folder = this.gui.addFolder("Picture");
    const auto = view.exposure === undefined || view.exposure === "auto";
    const model = { exposure: auto ? 0 : Number(view.exposure), auto, ambient: view.ambient ?? AMBIENT_DEFAULT, tonemap: view.tonemap ?? "aces", aa: view.aa ?? 1 };
    const set = (settings: ViewSettings): void => this.events.set(settings);
    this.shown = folder.add(this.choice, "show", this.hello.capabilities.show).onChange((show: string) => set({ show }));
    describe(this.shown, "show", "What the picture shows (v goes through them)");
    const automatic = folder.add(model, "auto").name("automatic exposure").onChange((on: boolean) => {
      exposure.enable(!on);
      set({ exposure: on ? "auto" : model.exposure });
    });
    describe(automatic, "exposure-auto", "From the lights and the scene's size alone, so that it stands still while you move");
    const exposure = folder.add(model, "exposure", -16, 16, 0.1).name("exposure (stops)").onChange((value: number) => set({ exposure: value }));
    describe(exposure, "exposure", "Doublings of brightness").enable(!auto);
    describe(folder.add(model, "ambient", 0, 1, 0.005).onChange((ambient: number) => set({ ambient })), "ambient", "White light from everywhere; shadows are filled by it");
    describe(folder.add(model, "tonemap", TONEMAPS).name("tone mapping").onChange((tonemap: string) => set({ tonemap })), "tonemap", "How bright light is fitted into 8 bits");
    describe(folder.add(model, "aa", SAMPLES).name("samples (a pixel)").onChange((aa: number) => set({ aa })), "aa", "Antialiasing: 1, 4 or 16 samples a pixel");
    const sharp = folder.add({ sharpness: 1 }, "sharpness", SHARPNESS).name("resolution").onChange((scale: number) => this.events.sharpness(scale));
    describe(sharp, "sharpness", "Rendered pixels for each of the screen's: less is faster");
  }

  private buildStream(view: ViewInfo): void {
    const folder = this.gui.addFolder("Stream").close();
    const model = { codec: view.codec, quality: view.quality, fps: 0 };
    const set = (settings: ViewSettings): void => this.events.set(settings);
    describe(folder.add(model, "codec", this.hello.capabilities.codecs).onChange((codec: string) => set({ codec })), "codec", "How frames are packed");
    describe(folder.add(model, "quality", 1, 100, 1).onChange((quality: number) => set({ quality })), "quality", "Of moving frames, 1 to 100; still ones get 90 or better");
    describe(folder.add(model, "fps", 0, 120, 1).name("limit (frames/s)").onChange((fps: number) => set({ fps })), "fps", "Most frames a second; 0: no limit");
  }

  private buildSnapshot(): void {
    const folder = this.gui.addFolder("Snapshot").close();
    const model: Snapshot = { width: 1920, height: 1080, format: "png", aa: 4, quality: 90 };
    const most = this.hello.limits["snapshot_side"] ?? 16384;
    for (const side of ["width", "height"] as const)
      describe(folder.add(model, side).min(1).step(1).name(`${side} (pixels)`), `snapshot-${side}`, `1 to ${most}; the picture is rendered anew at this size`);
    describe(folder.add(model, "format", this.hello.capabilities.formats), "snapshot-format", "EXR is linear, before tone mapping");
    describe(folder.add(model, "quality", 1, 100, 1), "snapshot-quality", "Of JPEG and WebP, 1 to 100");
    describe(folder.add(model, "aa", SAMPLES).name("samples (a pixel)"), "snapshot-aa", "Antialiasing");
    describe(folder.add({ save: () => this.events.snapshot({ ...model }) }, "save").name("Save"), "snapshot-save", "Renders and downloads the picture");
  }

  private buildShare(): void {
    const folder = this.gui.addFolder("Share").close();
    const copies: [Shared, string, string][] = [
      ["link", "Copy the address", "A link to this server with scene, camera, lights, system and what is shown"],
      ["render", "Copy as gnomon render", "The command that makes this very picture (k)"],
      ["compare", "Copy as gnomon compare", "The command that measures this view's error"],
      ["curl", "Copy as curl", "The same picture over HTTP, from this server"],
    ];
    for (const [what, label, help] of copies) describe(folder.add({ copy: () => this.events.share(what) }, "copy").name(label), `share-${what}`, help);
  }
}
