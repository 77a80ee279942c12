// The canvas: decodes and draws frames in order, measures itself in device pixels, and bends the last frame to the newest camera while the
// next one is late.
import { FLAG_STILL, type Frame } from "./frame.js";
import { nowUs } from "./client.js";
import { warp } from "./projection.js";
import type { LookAt } from "./protocol.js";
import type { Answer } from "./steering.js";
import { type FrameTiming, timeFrame } from "./timings.js";

// Up to here a late frame is not noticed; bending costs the machine a composition that the next frame may need.
const LATE_MS = 45;
const DPR_MAX = 4;

export class Picture {
  camera: LookAt | undefined; // of the frame that is shown
  private bent = false;
  private newest = 0;
  private device: [number, number] | undefined; // exact size in device pixels, where the browser tells it
  private readonly context: CanvasRenderingContext2D;

  constructor(
    readonly canvas: HTMLCanvasElement,
    resized: () => void,
  ) {
    this.context = canvas.getContext("2d", { alpha: false })!;
    const observer = new ResizeObserver(([entry]) => {
      const box = entry?.devicePixelContentBoxSize?.[0];
      // Emulated screens report CSS pixels here.
      const plausible = box && Math.abs(box.inlineSize - canvas.clientWidth * devicePixelRatio) < 2;
      this.device = plausible ? [box.inlineSize, box.blockSize] : undefined;
      resized();
    });
    try {
      observer.observe(canvas, { box: "device-pixel-content-box" });
    } catch {
      observer.observe(canvas);
    }
  }

  // What to ask the server for: as many pixels as the screen shows, within its limits.
  size(limits: Record<string, number>, sharpness = 1): { size: [number, number]; dpr: number } {
    const { canvas } = this;
    const width = Math.max(1, canvas.clientWidth), height = Math.max(1, canvas.clientHeight);
    const side = (limits["stream_side"] ?? 8192) / Math.max(width, height);
    const area = Math.sqrt((limits["stream_pixels"] ?? 33554432) / (width * height));
    const own = Math.min(DPR_MAX, window.devicePixelRatio || 1);
    const dpr = Math.max(0.1, Math.min(own * sharpness, side * 0.999, area * 0.999));
    if (dpr !== own || !this.device) return { size: [width, height], dpr };
    return { size: [Math.max(1, this.device[0]) / dpr, Math.max(1, this.device[1]) / dpr], dpr };
  }

  restart(): void {
    this.newest = 0;
    this.camera = undefined;
    delete this.canvas.dataset["frame"];
    delete this.canvas.dataset["still"];
  }

  // Undefined where a newer frame was drawn first.
  async show(frame: Frame, answer: () => Answer): Promise<FrameTiming | undefined> {
    // Without a GPU, 1280 x 720: 5.4 ms and 0.1 to draw; ImageDecoder 2.2 and 4.6, on the page's own thread; an img element 11.
    const picture = await createImageBitmap(new Blob([frame.payload as BlobPart], { type: `image/${frame.codec}` }));
    const decodedUs = nowUs();
    if (frame.frame <= this.newest) {
      picture.close();
      return undefined;
    }
    const { canvas } = this;
    this.newest = frame.frame;
    if (canvas.width !== picture.width) canvas.width = picture.width;
    if (canvas.height !== picture.height) canvas.height = picture.height;
    this.context.drawImage(picture, 0, 0);
    const drawnUs = nowUs();
    picture.close();
    const { camera, sentUs } = answer();
    this.camera = camera;
    this.straighten();
    const still = (frame.flags & FLAG_STILL) !== 0;
    canvas.dataset["frame"] = String(frame.frame);
    canvas.dataset["still"] = String(still);
    return timeFrame(frame, decodedUs, drawnUs, still ? undefined : sentUs);
  }

  // Call while a frame is awaited; `waitingMs` is how long the oldest unanswered input waits. False: the picture stays as it is.
  bend(to: LookAt, waitingMs: number): boolean {
    if (!this.camera || waitingMs < LATE_MS) return false;
    const transform = warp(this.camera, to, this.canvas.clientWidth, this.canvas.clientHeight);
    if (!transform) return false;
    this.canvas.style.transform = transform;
    this.bent = true;
    return true;
  }

  straighten(): void {
    if (this.bent) this.canvas.style.transform = "";
    this.bent = false;
  }
}
