// Live charts: what each frame took, and each second's passes on the server.
import uPlot from "uplot";
import type { ViewStats } from "./protocol.js";
import type { Timings } from "./timings.js";

const SPAN_SECONDS = 30;
const REFRESH_MS = 400; // drawing competes with decoding for the page's thread
const HEIGHT = 120;
const TICKS = [-30, -20, -10, 0];
const FRAME_SERIES = ["motion to photon", "render", "encode", "decode"] as const;
const COLOURS = ["--chart-1", "--chart-2", "--chart-3", "--chart-4", "--chart-5", "--chart-6", "--chart-7", "--chart-8"];

const styleOf = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Charts {
  private frames: uPlot | undefined;
  private passes: uPlot | undefined;
  private passNames: string[] = [];
  private readonly seconds: { at: number; passes: Record<string, number> }[] = [];
  private drawn = -1;
  private now = 0;

  constructor(
    private readonly frameRoot: HTMLElement,
    private readonly passRoot: HTMLElement,
    private readonly timings: Timings,
  ) {
    new ResizeObserver(() => this.resize()).observe(frameRoot);
    setInterval(() => this.refresh(), REFRESH_MS);
  }

  add(stats: ViewStats): void {
    this.seconds.push({ at: performance.now() / 1000, passes: stats.passes });
    if (this.seconds.length > 2 * SPAN_SECONDS) this.seconds.splice(0, SPAN_SECONDS);
  }

  // Colours come from the page's style, which changed.
  restyle(): void {
    this.frames?.destroy();
    this.passes?.destroy();
    this.frames = this.passes = undefined;
    this.drawn = -1;
  }

  private make(root: HTMLElement, names: readonly string[], label: string): uPlot {
    const axis = { stroke: styleOf("--dim"), grid: { stroke: styleOf("--line"), width: 1 }, ticks: { stroke: styleOf("--line"), size: 4 }, font: "10px system-ui" };
    root.setAttribute("aria-label", label);
    const made = new uPlot(
      {
        width: Math.max(120, root.clientWidth),
        height: HEIGHT,
        cursor: { y: false, drag: { x: false, y: false } },
        legend: { live: true },
        scales: { x: { time: false, range: () => [this.now - SPAN_SECONDS, this.now] }, y: { range: (_, __, max) => [0, Math.max(1, (max || 0) * 1.1)] } },
        axes: [{ ...axis, size: 20, splits: () => TICKS.map((t) => this.now + t), values: () => TICKS.map((t) => (t ? `${t} s` : "now")) }, { ...axis, size: 46, values: (_, ticks) => ticks.map((t) => (t >= 1000 ? `${t / 1000} s` : `${t} ms`)) }],
        series: [
          { label: "", value: () => "" },
          ...names.map((name, i) => ({ label: name, stroke: styleOf(COLOURS[i % COLOURS.length]!), width: 1.5, spanGaps: true, points: { show: false }, value: (_: uPlot, v: number | null) => (v == null ? "–" : `${v.toFixed(1)} ms`) })),
        ],
      },
      [[], ...names.map(() => [])] as uPlot.AlignedData,
      root,
    );
    return made;
  }

  private resize(): void {
    this.frames?.setSize({ width: Math.max(120, this.frameRoot.clientWidth), height: HEIGHT });
    this.passes?.setSize({ width: Math.max(120, this.passRoot.clientWidth), height: HEIGHT });
  }

  private refresh(): void {
    const now = performance.now() / 1000;
    const newest = this.timings.last?.seconds ?? 0;
    const hidden = document.hidden || this.frameRoot.offsetParent === null;
    if (hidden || (newest === this.drawn && now - newest > SPAN_SECONDS)) return;
    this.drawn = newest;
    this.frames ??= this.make(this.frameRoot, FRAME_SERIES, "Chart of what each frame took, the last 30 seconds");
    this.now = now;
    const kept = this.timings.frames.filter((t) => t.seconds > now - SPAN_SECONDS);
    this.frames.setData([
      kept.map((t) => t.seconds),
      kept.map((t) => t.photonMs),
      kept.map((t) => t.renderMs),
      kept.map((t) => t.encodeMs),
      kept.map((t) => t.decodeMs),
    ]);
    this.showNewest(this.frames, kept.length);
    this.refreshPasses(now);
  }

  private refreshPasses(now: number): void {
    const kept = this.seconds.filter((s) => s.at > now - SPAN_SECONDS);
    const names = [...new Set(kept.flatMap((s) => Object.keys(s.passes).filter((name) => s.passes[name]! > 0)))];
    if (names.length === 0) return;
    if (!this.passes || names.some((name) => !this.passNames.includes(name))) {
      this.passes?.destroy();
      this.passNames = names;
      this.passes = this.make(this.passRoot, names.map((name) => name.replace(/_ms$/, "")), "Chart of the passes of the newest frame, each second");
    }
    this.passes.setData([kept.map((s) => s.at), ...this.passNames.map((name) => kept.map((s) => s.passes[name] ?? null))] as uPlot.AlignedData);
    this.showNewest(this.passes, kept.length);
  }

  // Without a pointer over the chart its legend tells the newest values.
  private showNewest(chart: uPlot, count: number): void {
    if (count === 0 || (chart.cursor.left ?? -1) >= 0) return;
    setTimeout(() => chart.root.isConnected && chart.setLegend({ idx: count - 1 })); // after the redraw that setData began, which empties it
  }
}
