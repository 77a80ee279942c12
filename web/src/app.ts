// The page: one canvas, one view, its lights, a panel, figures.
import { withoutDefaults } from "./algorithm.js";
import { Charts } from "./charts.js";
import {
  type Client, type CompareSettings, FLAG_STILL, type Frame, type Hello, type Light, type LightKind, type LightsResult, type LookAt, nowUs, RpcError, type SceneChanged,
  type SceneInfo, type ViewInfo, type ViewSettings,
} from "./client.js";
import { Connection } from "./connection.js";
import { Figures } from "./figures.js";
import { listen } from "./gestures.js";
import { Handles, type Space } from "./handles.js";
import { fillHelp } from "./help.js";
import { Keeping } from "./keeping.js";
import { type Held, listenKeys, type Pressed } from "./keys.js";
import { asKind, newLight } from "./lights.js";
import { Address, readLink } from "./link.js";
import { Measuring } from "./measuring.js";
import { Messages } from "./messages.js";
import { Orbit } from "./orbit.js";
import { Panel, type PanelEvents } from "./panel.js";
import { Picture } from "./picture.js";
import { remember, remembered } from "./remember.js";
import { Steering } from "./steering.js";
import { ThemeSwitch } from "./theme.js";
import { Timings } from "./timings.js";
import { add, length, scale } from "./vectors.js";
import { comparable, type Shown } from "./words.js";

const byId = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

const url = new URL("ws", location.href);
url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
url.search = location.search; // ?token=
url.hash = "";

const STAND_OFF = 2; // of the scene's radius: where orthographic cameras stand to see all of it
const KEY_TURN = 0.35; // picture heights a second
const KEY_PAN = 0.5;
const KEY_ZOOM = 2.2; // factor a second
const HINTED = "gnomon-hinted";
const HINT_MS = 12000;
const COMPLAINT_CODES = [-32602, -32000, -32001]; // what an old view asks for, and this server does not have

class App {
  private hello: Hello | undefined;
  private view: ViewInfo | undefined;
  private orbit: Orbit | undefined;
  private panel: Panel | undefined;
  private lights: Light[] = [];
  private space: Space = { center: [0, 0, 0], radius: 1 };
  private wanted: ViewSettings = readLink(); // what to ask for again after a reconnect
  private sharpness = 1;
  private ticking = false;
  private dragging = false; // a light: the handle leads, answers follow
  private refused: RpcError | undefined;
  private opening: AbortController | undefined;
  private readonly address = new Address();
  private readonly timings = new Timings();
  private readonly picture = new Picture(byId<HTMLCanvasElement>("picture"), () => this.resize());
  private readonly messages = new Messages(byId("message"), byId("status"), byId("retry"), byId("token"));
  private readonly charts = new Charts(byId("frame-chart"), byId("pass-chart"), this.timings);
  private readonly figures = new Figures(this.timings);
  private readonly handles = new Handles(byId("handles"), {
    move: (index, change, timeUs) => this.dragLight(index, change, timeUs),
    end: (index) => void this.changeLight(index, {}),
    remove: (index) => void this.removeLight(index),
  });
  private readonly steering = new Steering(
    {
      steer: (settings, timeUs) => this.client!.steer(this.view!.view, settings, timeUs),
      steerLight: (index, light, timeUs) => this.client!.steerLight(this.view!.view, index, light, timeUs),
    },
    () => this.orbit?.camera,
  );
  private readonly measuring = new Measuring(
    byId("difference"),
    { client: () => this.client, settings: () => this.toCompare(), error: (error) => this.messages.error(error) },
    () => this.panel?.compare,
  );
  private readonly keeping = new Keeping(
    { client: () => this.client, shown: () => this.shown(), against: () => this.panel?.compare.against ?? "point", link: () => this.address.write(this.wanted) },
    this.messages,
    byId("copy"),
  );
  private readonly connection: Connection;

  constructor() {
    const theme = new ThemeSwitch(byId("theme"), () => this.charts.restyle());
    listen(this.picture.canvas, {
      turn: (dx, dy, timeUs) => this.steer(timeUs, (orbit) => orbit.turn(dx, dy)),
      pan: (dx, dy, timeUs) => this.steer(timeUs, (orbit) => orbit.pan(dx, dy)),
      zoom: (factor, x, y, timeUs) => this.steer(timeUs, (orbit) => orbit.zoom(factor, x, y)),
    });
    this.listenKeys(theme);
    this.listenPage();
    this.connection = new Connection(url.href, {
      hello: (hello) => void this.greet(hello),
      frame: (frame) => this.draw(frame),
      stats: (stats) => {
        this.charts.add(stats);
        this.figures.stats = stats;
      },
      viewError: (error) => this.messages.error(new RpcError(error.code, error.message, error.data ?? undefined)),
      sceneChanged: (change) => void this.sceneChanged(change),
      explain: explainRefusal,
      status: (status) => {
        this.messages.connection(status);
        if (status.state === "lost") this.view = undefined;
      },
    });
  }

  private get client() {
    return this.connection.client;
  }

  private listenKeys(theme: ThemeSwitch): void {
    const turn = (dx: number, dy: number) => (s: number) => this.steer(nowUs(), (o) => o.turn(dx * s * KEY_TURN, dy * s * KEY_TURN));
    const pan = (dx: number, dy: number) => (s: number) => this.steer(nowUs(), (o) => o.pan(dx * s * KEY_PAN, dy * s * KEY_PAN));
    const zoom = (way: number) => (s: number) => this.steer(nowUs(), (o) => o.zoom(KEY_ZOOM ** (way * s)));
    const held: Held[] = [
      { keys: ["ArrowLeft"], label: "←  →", help: "orbit around", move: turn(-1, 0) },
      { keys: ["ArrowRight"], label: "", help: "", move: turn(1, 0) },
      { keys: ["ArrowUp"], label: "↑  ↓", help: "orbit over and under", move: turn(0, -1) },
      { keys: ["ArrowDown"], label: "", help: "", move: turn(0, 1) },
      { keys: ["Shift+ArrowLeft", "a"], label: "a  d  Shift ←  →", help: "pan sideways", move: pan(1, 0) },
      { keys: ["Shift+ArrowRight", "d"], label: "", help: "", move: pan(-1, 0) },
      { keys: ["Shift+ArrowUp", "w"], label: "w  s  Shift ↑  ↓", help: "pan up and down", move: pan(0, 1) },
      { keys: ["Shift+ArrowDown", "s"], label: "", help: "", move: pan(0, -1) },
      { keys: ["+", "=", "PageUp"], label: "+  −  Page up  Page down", help: "zoom", move: zoom(-1) },
      { keys: ["-", "_", "PageDown"], label: "", help: "", move: zoom(1) },
    ];
    const pressed: Pressed[] = [
      { keys: ["Home", "h"], label: "Home  h", help: "back to the scene's camera", act: () => this.home() },
      { keys: ["]"], label: "]  [", help: "next, previous shadow system", act: () => this.panel?.nextAlgorithm(1) },
      { keys: ["["], label: "", help: "", act: () => this.panel?.nextAlgorithm(-1) },
      { keys: ["v"], label: "v", help: "what the picture shows: shaded, visibility, depth …", act: () => this.panel?.nextShow() },
      { keys: ["l"], label: "l", help: "light handles on and off", act: () => this.toggleHandles() },
      { keys: ["p"], label: "p", help: "panel on and off", act: () => this.togglePanel() },
      { keys: ["t"], label: "t", help: "dark, light, or as the system has it", act: () => theme.next() },
      { keys: ["f"], label: "f", help: "full screen", act: () => this.toggleFullscreen() },
      { keys: ["c"], label: "c", help: "save what you see as a picture", act: () => this.saveView() },
      { keys: ["k"], label: "k", help: "copy the command that makes this picture", act: () => void this.keeping.share("render") },
      { keys: ["m"], label: "m", help: "measure the error of what you see, or give up measuring", act: () => this.panel?.compare.act() },
      { keys: ["e"], label: "e", help: "difference picture, once measured", act: () => this.measuring.toggle() },
      { keys: ["?"], label: "?", help: "this help; Escape closes it", act: () => byId<HTMLDialogElement>("help").showModal() },
    ];
    listenKeys(held, pressed);
    fillHelp(byId<HTMLDialogElement>("help"), held.filter((h) => h.label), pressed.filter((p) => p.label));
  }

  private listenPage(): void {
    const click = (id: string, act: () => void): void => byId(id).addEventListener("click", act);
    click("toggle", () => this.togglePanel());
    click("home", () => this.home());
    click("handles-toggle", () => this.toggleHandles());
    click("save", () => this.saveView());
    click("fullscreen", () => this.toggleFullscreen());
    click("show-help", () => byId<HTMLDialogElement>("help").showModal());
    click("close-help", () => byId<HTMLDialogElement>("help").close());
    click("retry", () => this.connection.retry());
    byId("token").addEventListener("submit", (event) => {
      event.preventDefault();
      location.search = `?token=${encodeURIComponent(byId("token").querySelector("input")!.value.trim())}`;
    });
    window.addEventListener("hashchange", () => void this.openView(readLink()));
    window.addEventListener("online", () => this.connection.retry());
    document.addEventListener("visibilitychange", () => {
      if (this.view) this.steering.view({ pause: document.hidden }, nowUs());
      if (!document.hidden) this.connection.retry();
    });
  }

  private async greet(hello: Hello): Promise<void> {
    this.hello = hello;
    this.view = undefined;
    byId("version").textContent = hello.version;
    byId("device").textContent = hello.capabilities.device;
    if (await this.openView(this.wanted)) return this.hint();
    // A server that was replaced may not know what the old one did.
    if (this.refused && COMPLAINT_CODES.includes(this.refused.code)) {
      const { refused } = this;
      if (await this.openView({})) this.messages.error(refused);
    }
  }

  // Once for each browser.
  private hint(): void {
    if (remembered(HINTED)) return;
    remember(HINTED, "yes");
    this.messages.note("Drag to look around; drag the numbered sun to move the light; m measures the shadows' error; ? for help", HINT_MS);
  }

  // The newest wish wins: one that is under way is given up.
  private async openView(settings: ViewSettings): Promise<boolean> {
    const { client, view: old } = this;
    if (!client || !this.hello) return false;
    this.opening?.abort();
    const own = (this.opening = new AbortController());
    this.refused = undefined;
    const what = settings.scene ? `Loading ${settings.scene} …` : "Loading …";
    const progress = this.messages.follow(what, old ? () => own.abort() : undefined);
    try {
      this.steering.flush();
      const opened = await client.openView({ ...settings, pause: document.hidden, ...this.size() }, { signal: own.signal, progress });
      if (own !== this.opening) {
        client.notify("view.close", { view: opened.view });
        return true;
      }
      if (old) client.notify("view.close", { view: old.view });
      this.take(opened, settings);
      this.messages.clear();
      void this.describe(opened.scene);
      return true;
    } catch (error) {
      if (this.client !== client || own !== this.opening) return false; // the connection went, or another wish came: said elsewhere
      this.refused = error instanceof RpcError ? error : undefined;
      this.messages.error(error, "Loading was cancelled");
      if (old) this.panel?.sync(old);
      return false;
    }
  }

  private take(opened: ViewInfo, settings: ViewSettings): void {
    const fresh = !this.panel || this.hello !== this.panel.hello;
    this.view = opened;
    this.orbit = new Orbit(opened.camera);
    this.wanted = { ...settings, scene: opened.scene };
    this.picture.restart();
    this.steering.restart();
    this.steering.note(0);
    if (fresh) this.panel = new Panel(byId("panel"), this.hello!, this.panelEvents(), opened);
    else this.panel?.sync(opened);
    this.showLights(opened.lights);
    this.measuring.changed();
    this.address.write(this.wanted);
  }

  private async describe(scene: string): Promise<void> {
    try {
      const info = await this.client!.request<SceneInfo>("scene.describe", { scene });
      if (this.view?.scene !== scene) return;
      const { bounds } = info;
      if (bounds) this.space = { center: scale(add(bounds.min, bounds.max), 0.5), radius: length(add(bounds.max, bounds.min, -1)) / 2 || 1 };
      this.orbit?.standOff(STAND_OFF * this.space.radius);
      this.panel?.describeScene(info, this.wanted.camera);
      this.showLights(this.lights);
    } catch (error) {
      if (this.view) this.messages.error(error);
    }
  }

  private panelEvents(): PanelEvents {
    return {
      scene: (scene) => void this.openView({ ...this.wanted, scene, camera: undefined, lights: undefined }),
      camera: (camera) => void this.change({ camera }),
      set: (settings) => void this.change(settings),
      sharpness: (scale) => {
        this.sharpness = scale;
        this.resize();
      },
      snapshot: (settings) => void this.keeping.save(settings),
      share: (what) => void this.keeping.share(what),
      compare: {
        run: (against) => void this.measuring.run(against),
        cancel: () => this.measuring.cancel(),
        show: (on) => (on ? this.measuring.show() : this.measuring.hide()),
      },
      lights: {
        add: (kind) => void this.addLight(kind),
        change: (index, change) => void this.changeLight(index, change),
        become: (index, kind) => void this.changeLight(index, asKind(this.lights[index]!, kind, this.space)),
        remove: (index) => void this.removeLight(index),
      },
    };
  }

  private size(): ViewSettings {
    return this.picture.size(this.hello?.limits ?? {}, this.sharpness);
  }

  private resize(): void {
    if (this.view) this.steering.view(this.size(), nowUs());
    this.handles.place(this.picture.camera);
  }

  private home(): void {
    void this.change({ camera: this.panel?.homeCamera ?? "auto" });
  }

  // One after another, so that what was typed last is what stays.
  private async change(settings: ViewSettings): Promise<void> {
    const { client, view } = this;
    if (!client || !view) return;
    this.steering.flush();
    const moves = settings.camera !== undefined;
    try {
      const asked = client.setView(view.view, settings);
      if (!moves) this.steering.note(client.inputSeq);
      const now = await asked;
      if (this.view?.view !== view.view) return;
      this.view = now;
      Object.assign(this.wanted, settings);
      if (moves) this.jump(now.camera, settings.camera!);
      this.panel?.sync(now);
      this.messages.clear();
      this.measuring.changed();
      this.address.write(this.wanted);
    } catch (error) {
      if (this.client !== client) return;
      this.messages.error(error);
      this.panel?.sync(this.view ?? view);
    }
  }

  private jump(camera: LookAt, choice: LookAt | string | number): void {
    this.orbit = new Orbit(camera);
    this.orbit.standOff(STAND_OFF * this.space.radius);
    this.steering.restart();
    this.steering.note(0);
    if (typeof choice !== "object") this.panel?.cameraIs(choice);
  }

  private steer(timeUs: number, move: (orbit: Orbit) => void): void {
    if (!this.view || !this.orbit) return;
    move(this.orbit);
    this.wanted.camera = this.orbit.camera;
    this.steering.view({ camera: this.orbit.camera }, timeUs);
    this.panel?.cameraIs(undefined);
    this.measuring.changed();
    this.address.writeSoon(() => this.wanted);
    this.tickSoon();
  }

  // While frames are late, the last one follows the hand.
  private tickSoon(): void {
    if (this.ticking) return;
    this.ticking = true;
    requestAnimationFrame(() => {
      this.ticking = false;
      const waitingMs = this.steering.waitingMs;
      if (waitingMs === 0 || !this.orbit || !this.view) return;
      if (this.picture.bend(this.orbit.camera, waitingMs)) this.handles.place(this.orbit.camera);
      this.tickSoon();
    });
  }

  private async draw(frame: Frame): Promise<void> {
    if (frame.kind !== 0 || frame.view !== this.view?.view) return;
    const timing = await this.picture.show(frame, () => this.steering.answer(frame.inputSeq));
    if (!timing) return;
    this.timings.add(timing);
    this.picture.canvas.dispatchEvent(new CustomEvent("gnomon:frame", { detail: timing })); // for whoever measures
    if (!this.dragging) this.handles.place(this.picture.camera);
    if (frame.flags & FLAG_STILL) this.measuring.settled();
  }

  private async sceneChanged({ scene, reason, views }: SceneChanged): Promise<void> {
    const { client, view } = this;
    if (!client || !view || !views.includes(view.view)) return;
    if (reason === "removed") return this.messages.note(`${scene} is gone from the server's disk; this view keeps it as it was`);
    if (reason === "changed") {
      if (await this.openView(this.wanted)) this.messages.note(`${scene} has changed on disk: this is the new one`);
      return;
    }
    // Something else of it, told by a newer server: what it has now.
    const { lights } = await client.request<ViewInfo>("view.set", { view: view.view });
    if (this.view?.view === view.view && !this.dragging) this.showLights(lights);
  }

  private showLights(lights: Light[]): void {
    this.lights = lights;
    this.panel?.lights.set(lights, this.space.radius);
    this.handles.set(lights, this.space);
  }

  private dragLight(index: number, change: Partial<Light>, timeUs: number): void {
    if (!this.view) return;
    this.dragging = true;
    this.measuring.changed();
    this.steering.light(index, change, timeUs);
    this.panel?.lights.refresh(index, this.lights[index]!);
  }

  private async askLights(ask: (client: Client, view: number) => Promise<LightsResult>): Promise<void> {
    const { client, view } = this;
    if (!client || !view) return;
    this.steering.flush();
    try {
      const asked = ask(client, view.view);
      this.steering.note(client.inputSeq);
      const { lights } = await asked;
      if (this.view?.view !== view.view) return;
      this.wanted.lights = lights.map(withoutName);
      this.messages.clear();
      this.measuring.changed();
      this.address.writeSoon(() => this.wanted);
      if (!this.dragging) this.showLights(lights);
    } catch (error) {
      if (this.client !== client) return;
      this.messages.error(error);
      this.showLights(this.lights);
    }
  }

  private changeLight(index: number, change: Partial<Light>): Promise<void> {
    this.dragging = false;
    return this.askLights((client, view) => client.setLight(view, index, change));
  }

  private addLight(kind: LightKind): Promise<void> {
    const { width, height } = this.picture.canvas;
    const light = newLight(kind, this.orbit!.camera, width / height, this.space, this.lights);
    return this.askLights((client, view) => client.addLight(view, light));
  }

  private removeLight(index: number): Promise<void> {
    return this.askLights((client, view) => client.removeLight(view, index));
  }

  private saveView(): void {
    const { width, height } = this.picture.canvas;
    void this.keeping.save({ width, height, format: "png", aa: 4 });
  }

  // What the view shows, in full.
  private shown(): Shown | undefined {
    const { view, wanted } = this;
    if (!view) return undefined;
    const { scene, show, exposure, ambient, tonemap, aa } = view;
    const algorithm = withoutDefaults(this.hello!.algorithms, view.algorithm);
    const { width, height } = this.picture.canvas;
    const size: [number, number] = [width, height];
    const { name: _, ...own } = view.camera as LookAt & { name?: string };
    return { scene, size, algorithm, show, exposure, ambient, tonemap, aa, camera: wanted.camera ?? own, ...(wanted.lights && { lights: wanted.lights }) };
  }

  private toCompare(): CompareSettings | undefined {
    const shown = this.shown();
    if (!shown) return undefined;
    const [width, height] = shown.size;
    const less = Math.min(1, Math.sqrt((this.hello?.limits["compare_pixels"] ?? Infinity) / (width * height)));
    return { ...comparable(shown), size: [Math.max(1, Math.floor(width * less)), Math.max(1, Math.floor(height * less))] };
  }

  private toggleHandles(): void {
    const off = byId("handles").classList.toggle("off");
    byId("handles-toggle").setAttribute("aria-pressed", String(!off));
  }

  private togglePanel(): void {
    const bare = document.body.classList.toggle("bare");
    byId("toggle").setAttribute("aria-expanded", String(!bare));
  }

  private toggleFullscreen(): void {
    const done = document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen();
    done.catch((error: unknown) => this.messages.error(error));
  }
}

// Names come from the scene; the wire takes none back.
function withoutName({ name: _, ...light }: Light): Light {
  return light;
}

// A refused upgrade looks like a lost connection to a page; a plain request tells them apart.
async function explainRefusal(): Promise<string> {
  const { status } = await fetch(`${location.pathname}${location.search}`, { cache: "no-store" });
  if (status === 401) return "the server takes no client without a token that it knows, and this address has none of them";
  if (status === 403) return "the server does not answer to this address (see --allow-origin)";
  return "";
}

new App();
