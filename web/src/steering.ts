// What hands do, on its way to the server: the first movement goes at once, those that follow it closely go together; and which camera each
// input stood for, until the frame that shows it has come.
import type { Light, LookAt, ViewSettings } from "./protocol.js";

const GAP_MS = 6; // a mouse may move 1000 times a second; no frame is that fast

export interface Sender {
  steer(settings: ViewSettings, timeUs: number): number; // returns the input's number
  steerLight(index: number, light: Partial<Light>, timeUs: number): number;
}

export interface Answer {
  camera: LookAt | undefined;
  sentUs: number | undefined; // on the page's clock
}

interface Sent {
  seq: number;
  atMs: number;
  camera: LookAt | undefined;
}

export class Steering {
  private settings: ViewSettings | undefined;
  private readonly lights = new Map<number, Partial<Light>>();
  private timeUs = 0;
  private lastMs = -Infinity;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private sent: Sent[] = [];
  private shown: LookAt | undefined;

  constructor(
    private readonly sender: Sender,
    private readonly camera: () => LookAt | undefined,
  ) {}

  view(settings: ViewSettings, timeUs: number): void {
    this.settings = { ...this.settings, ...settings };
    this.soon(timeUs);
  }

  light(index: number, light: Partial<Light>, timeUs: number): void {
    this.lights.set(index, { ...this.lights.get(index), ...light });
    this.soon(timeUs);
  }

  // Sends what is held back: before anything that must come after it.
  flush(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    if (!this.settings && this.lights.size === 0) return;
    this.lastMs = performance.now();
    let seq = 0;
    if (this.settings) seq = this.sender.steer(this.settings, this.timeUs);
    for (const [index, light] of this.lights) seq = this.sender.steerLight(index, light, this.timeUs);
    this.settings = undefined;
    this.lights.clear();
    this.note(seq);
  }

  // Records which camera an input stands for.
  note(seq: number): void {
    this.sent.push({ seq, atMs: performance.now(), camera: this.camera() });
  }

  // What the frame that echoes `seq` shows; what it answers is forgotten. `sentUs` only where it is the first to show that input.
  answer(seq: number): Answer {
    let sentUs: number | undefined;
    while (this.sent[0] && this.sent[0].seq <= seq) {
      const { camera, atMs, seq: own } = this.sent.shift()!;
      this.shown = camera;
      if (own === seq) sentUs = Math.round((performance.timeOrigin + atMs) * 1000);
    }
    return { camera: this.shown, sentUs };
  }

  restart(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.settings = undefined;
    this.lights.clear();
    this.sent = [];
    this.shown = undefined;
  }

  // How long the oldest input has been without its frame.
  get waitingMs(): number {
    return this.sent[0] ? performance.now() - this.sent[0].atMs : 0;
  }

  private soon(timeUs: number): void {
    this.timeUs = timeUs;
    const wait = this.lastMs + GAP_MS - performance.now();
    if (wait <= 0) this.flush();
    else this.timer ??= setTimeout(() => this.flush(), wait);
  }
}
