// The page: one canvas, one view, a panel, figures.
import { Client, type Frame, type Hello, RpcError, type ViewInfo, type ViewSettings, type ViewStats, nowUs } from "./client.js";
import { listen } from "./gestures.js";
import { Orbit } from "./orbit.js";
import { Panel } from "./panel.js";

const byId = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;
const canvas = byId<HTMLCanvasElement>("picture");
const context = canvas.getContext("2d", { alpha: false })!;
const RETRY_MS = [250, 500, 1000, 2000, 5000];

const url = new URL("ws", location.href);
url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
url.search = location.search; // ?token=

class App {
  private client: Client | undefined;
  private view: ViewInfo | undefined;
  private orbit: Orbit | undefined;
  private attempts = 0;
  private drawn = 0;
  private wanted: ViewSettings = {}; // what to ask for again after a reconnect
  private latencyMs = 0;
  private frame: Frame | undefined;
  private stats: ViewStats | undefined;

  start(): void {
    listen(canvas, {
      turn: (dx, dy) => this.steer((orbit) => orbit.turn(dx, dy)),
      pan: (dx, dy) => this.steer((orbit) => orbit.pan(dx, dy)),
      zoom: (factor) => this.steer((orbit) => orbit.zoom(factor)),
    });
    new ResizeObserver(() => this.resize()).observe(canvas);
    byId("toggle").addEventListener("click", () => document.body.classList.toggle("bare"));
    byId("home").addEventListener("click", () => this.openView({ ...this.wanted, camera: undefined }));
    document.addEventListener("visibilitychange", () => {
      if (this.view) this.client?.steer(this.view.view, { pause: document.hidden });
    });
    this.connect();
  }

  private connect(): void {
    this.client = new Client(url.href, {
      hello: (hello) => void this.greet(hello),
      frame: (frame) => this.draw(frame),
      stats: (stats) => {
        this.stats = stats;
        this.showFigures();
      },
      viewError: (error) => this.tell(error.message, true),
      closed: (code, reason) => this.retry(code, reason),
    });
  }

  private retry(code: number, reason: string): void {
    this.view = undefined;
    const wait = RETRY_MS[Math.min(this.attempts++, RETRY_MS.length - 1)]!;
    this.tell(`Connection lost${reason ? `: ${reason}` : code === 1006 ? "" : ` (${code})`}. Trying again.`, true);
    setTimeout(() => this.connect(), wait);
  }

  private async greet(hello: Hello): Promise<void> {
    this.attempts = 0;
    byId("version").textContent = hello.version;
    byId("device").textContent = hello.capabilities.device;
    if (!(await this.openView(this.wanted)) || !this.view) return;
    new Panel(
      byId("panel"),
      hello,
      {
        scene: (scene) => void this.openView({ ...this.wanted, scene, camera: undefined }),
        algorithm: (algorithm) => void this.change({ algorithm }),
        show: (show) => void this.change({ show }),
      },
      this.view,
    );
  }

  private size(): ViewSettings {
    return { size: [Math.max(1, canvas.clientWidth), Math.max(1, canvas.clientHeight)], dpr: Math.min(4, window.devicePixelRatio || 1) };
  }

  private async openView(settings: ViewSettings): Promise<boolean> {
    const old = this.view;
    this.tell(settings.scene ? `Loading ${settings.scene} …` : "Loading …");
    try {
      const opened = await this.client!.openView({ ...settings, ...this.size() });
      if (old && this.view === old) this.client!.notify("view.close", { view: old.view });
      this.view = opened;
      this.orbit = new Orbit(opened.camera);
      this.wanted = { ...settings, scene: opened.scene };
      this.drawn = 0;
      this.tell("");
      return true;
    } catch (error) {
      this.tell(error instanceof RpcError ? error.message : String(error), true);
      return false;
    }
  }

  private async change(settings: ViewSettings): Promise<void> {
    if (!this.view) return;
    try {
      await this.client!.setView(this.view.view, settings);
      Object.assign(this.wanted, settings);
      this.tell("");
    } catch (error) {
      this.tell(error instanceof RpcError ? error.message : String(error), true);
    }
  }

  private steer(move: (orbit: Orbit) => void): void {
    if (!this.view || !this.orbit) return;
    move(this.orbit);
    this.wanted.camera = this.orbit.camera;
    this.client!.steer(this.view.view, { camera: this.orbit.camera });
  }

  private resize(): void {
    if (this.view) this.client!.steer(this.view.view, this.size());
  }

  private async draw(frame: Frame): Promise<void> {
    if (frame.view !== this.view?.view && this.view) return;
    const picture = await createImageBitmap(new Blob([frame.payload as BlobPart], { type: `image/${frame.codec}` }));
    if (frame.frame > this.drawn) {
      this.drawn = frame.frame;
      this.frame = frame;
      if (canvas.width !== picture.width) canvas.width = picture.width;
      if (canvas.height !== picture.height) canvas.height = picture.height;
      context.drawImage(picture, 0, 0);
      canvas.dataset["frame"] = String(frame.frame);
      canvas.dataset["still"] = String((frame.flags & 2) !== 0);
      // A still frame answers no input: its age says nothing.
      if (frame.inputTimeUs && !(frame.flags & 2)) requestAnimationFrame(() => (this.latencyMs = (nowUs() - frame.inputTimeUs) / 1000));
      this.showFigures();
    }
    picture.close();
  }

  private showFigures(): void {
    const set = (id: string, text: string): void => void (byId(id).textContent = text);
    const ms = (us: number): string => `${(us / 1000).toFixed(1)} ms`;
    if (this.frame) {
      set("size", `${this.frame.width} × ${this.frame.height}`);
      set("render", ms(this.frame.renderUs));
      set("encode", ms(this.frame.encodeUs));
      set("bytes", `${(this.frame.payload.length / 1024).toFixed(0)} KiB`);
      set("latency", this.latencyMs ? `${this.latencyMs.toFixed(0)} ms` : "–");
    }
    if (this.stats) {
      set("fps", this.stats.fps.toFixed(0));
      set("rtt", `${this.stats.rtt_ms.toFixed(1)} ms`);
      set("shadow", `${(this.stats.shadow_bytes / 1048576).toFixed(1)} MiB`);
    }
  }

  private tell(text: string, bad = false): void {
    const message = byId("message");
    message.textContent = text;
    message.hidden = text === "";
    message.classList.toggle("bad", bad);
  }
}

new App().start();
