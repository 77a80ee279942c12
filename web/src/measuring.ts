// Comparisons with a reference: asked for by the panel, given up when the picture changes, shown as figures and as a picture over the view.
import { CANCELLED, type Client, type CompareSettings, type Comparison, type Frame, type Progress, RpcError } from "./client.js";
import type { ComparePanel } from "./compare_panel.js";

export interface MeasuringEvents {
  client(): Client | undefined;
  settings(): CompareSettings | undefined; // of what is shown; undefined while nothing is
  error(error: unknown): void;
}

const STAGES: Record<string, string> = { waiting: "waiting", rendering: "rendering", comparing: "tracing rays", encoding: "packing" };

export class Measuring {
  private running: AbortController | undefined;
  private picture: Frame | undefined;
  private readonly context: CanvasRenderingContext2D;

  constructor(
    private readonly overlay: HTMLElement,
    private readonly events: MeasuringEvents,
    private readonly panel: () => ComparePanel | undefined,
  ) {
    this.context = overlay.querySelector("canvas")!.getContext("2d")!;
    overlay.querySelector("button")!.addEventListener("click", () => this.hide());
  }

  async run(against: string): Promise<void> {
    this.running?.abort();
    const own = new AbortController();
    const client = this.events.client(), settings = this.events.settings();
    if (!client || !settings) return;
    this.running = own;
    this.panel()?.progress("starting");
    try {
      const asked = { ...settings, against, difference: "png" };
      const { figures, frame } = await client.compare(asked, { signal: own.signal, progress: (p) => own === this.running && this.tell(p) });
      if (own !== this.running) return;
      await this.take(figures, frame);
      this.end();
    } catch (error) {
      if (own !== this.running) return;
      this.end();
      if (!(error instanceof RpcError && (error.code === CANCELLED || client !== this.events.client()))) this.events.error(error);
    }
  }

  cancel(): void {
    this.running?.abort();
    this.end();
  }

  // The view shows something else now: what was measured is of another picture.
  changed(): void {
    this.hide();
    this.picture = undefined;
    this.panel()?.stale();
    if (this.panel()?.live) this.cancel();
  }

  // The view has come to rest.
  settled(): void {
    const panel = this.panel();
    if (panel?.live && panel.isStale && !this.running) void this.run(panel.against);
  }

  show(): void {
    if (this.picture) this.overlay.hidden = false;
  }

  hide(): void {
    this.overlay.hidden = true;
  }

  toggle(): void {
    if (this.overlay.hidden) this.show();
    else this.hide();
  }

  private end(): void {
    this.running = undefined;
    this.panel()?.progress(undefined);
  }

  private tell({ stage, done }: Progress): void {
    this.panel()?.progress(`${STAGES[stage] ?? stage}${done ? ` ${Math.round(100 * done)} %` : ""}`);
  }

  private async take(figures: Comparison, frame: Frame | undefined): Promise<void> {
    this.panel()?.take(figures);
    this.picture = frame;
    if (!frame) return;
    const picture = await createImageBitmap(new Blob([frame.payload as BlobPart], { type: `image/${frame.codec}` }));
    const { canvas } = this.context;
    canvas.width = picture.width;
    canvas.height = picture.height;
    this.context.drawImage(picture, 0, 0);
    picture.close();
    const { algorithm, against, misclassified_fraction, rmse } = figures;
    this.overlay.querySelector("span")!.textContent = `${algorithm} against ${against}: ${(100 * misclassified_fraction).toPrecision(2)} % of pixels wrong, rms ${rmse.toPrecision(2)}`;
    if (this.panel()?.shows) this.show();
  }
}
