// The numbers under the chart and the line over the picture, four times a second: text that changes with each frame costs frames.
import type { ViewStats } from "./protocol.js";
import type { Timings } from "./timings.js";

const REFRESH_MS = 250;
const FRESH_SECONDS = 1.5;

const ms = (value: number | undefined): string => (value === undefined ? "–" : `${value.toFixed(1)} ms`);
const set = (id: string, text: string): void => {
  const element = document.getElementById(id)!;
  if (element.textContent !== text) element.textContent = text;
};

const short = (value: number): string => (Number.isInteger(value) ? value.toLocaleString("en") : value.toPrecision(3));

export class Figures {
  stats: ViewStats | undefined;
  private readonly list = document.getElementById("own-figures")!;

  constructor(private readonly timings: Timings) {
    setInterval(() => this.refresh(), REFRESH_MS);
  }

  private fps(): number {
    const now = performance.now() / 1000;
    const recent = this.timings.frames.slice(-200).filter((t) => t.seconds > now - FRESH_SECONDS);
    const first = recent[0];
    return first && recent.length > 1 ? (recent.length - 1) / Math.max(0.001, recent.at(-1)!.seconds - first.seconds) : 0;
  }

  private refresh(): void {
    const { last } = this.timings;
    if (!last || document.hidden) return;
    const moving = this.fps();
    const photon = this.timings.median((t) => t.photonMs), decode = this.timings.median((t) => t.decodeMs);
    set("size", `${last.width} × ${last.height}`);
    set("render", ms(last.renderMs));
    set("encode", ms(last.encodeMs));
    set("decode", ms(decode));
    set("latency", ms(photon));
    set("bytes", `${(last.bytes / 1024).toFixed(0)} KiB`);
    set("fps", moving ? moving.toFixed(1) : "still");
    set("hud", [moving ? `${moving.toFixed(0)} frames/s` : "still", photon === undefined ? "" : `${photon.toFixed(0)} ms to photon`, `${last.width} × ${last.height}`].filter(Boolean).join(" · "));
    if (!this.stats) return;
    set("rtt", ms(this.stats.rtt_ms));
    set("dropped", String(this.stats.dropped));
    set("shadow", `${(this.stats.shadow_bytes / 1048576).toFixed(1)} MiB`);
    this.own(this.stats);
  }

  // What the system tells of itself, by its own names.
  private own({ algorithm, figures }: ViewStats): void {
    const told = Object.entries(figures ?? {}).filter((entry): entry is [string, number] => typeof entry[1] === "number");
    const names = `${algorithm}:${told.map(([name]) => name).join()}`;
    if (this.list.dataset["of"] !== names) {
      this.list.dataset["of"] = names;
      const title = `Of the first light, as ${algorithm} tells it`;
      this.list.replaceChildren(...told.flatMap(([name]) => [
        Object.assign(document.createElement("dt"), { textContent: name.replace(/_/g, " "), title }), document.createElement("dd"),
      ]));
    }
    told.forEach(([, value], i) => (this.list.children[2 * i + 1]!.textContent = short(value)));
  }
}
