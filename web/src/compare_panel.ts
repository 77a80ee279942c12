// The controls and figures of a comparison. The systems come from server.hello; what a figure is called and its unit stand here, and figures that
// have no line here are shown by their own name.
import type { Controller, GUI } from "lil-gui";
import { describe } from "./controls.js";
import type { Comparison, Hello } from "./protocol.js";

export interface CompareEvents {
  run(against: string): void;
  cancel(): void;
  show(on: boolean): void;
}

// The references that are no system of their own: REF in proto/README.md.
const REFERENCES: Record<string, string> = { "ray traced, 1 ray": "point", "ray traced, 32 samples": "samples32", "ray traced, area lights": "arealight" };
const MEASURE = "Measure";

type Say = (value: number) => string;
interface Row {
  label: string;
  help: string;
  say: Say;
}

const count: Say = (n) => n.toLocaleString("en");
const part: Say = (x) => x.toPrecision(3);
const percent = (x: number): string => `${(100 * x).toPrecision(3)} %`;
const pixels: Say = (n) => `${(n / 32).toFixed(2)} px`; // the wire counts in 1/32

const ROWS: Record<string, Row> = {
  misclassified: { label: "Wrong pixels", help: "Where more than half of the light is wrongly there or wrongly missing; of the pixels that face a light", say: count },
  misclassified_fraction: { label: "Wrong, of receivers", help: "The same as a part of the pixels that face a light", say: percent },
  rmse: { label: "Error (rms)", help: "Root mean square of the difference in visibility, 0 to 1, over pixels that face a light", say: part },
  max_abs: { label: "Largest error", help: "Of any pixel, 0 to 1", say: part },
  leaks: { label: "Leaks", help: "Wrong pixels with light where all around is shadow", say: count },
  acne: { label: "Acne", help: "Wrong pixels with shadow where all around is light", say: count },
  "boundary.rmse": { label: "Error at edges", help: "Root mean square over the pixels at shadow edges alone", say: part },
  "boundary.edge_shift_mean": { label: "Edge shift, mean", help: "How far shadow edges are from where they belong; pixels, 8 at most", say: pixels },
  "boundary.edge_shift_p95": { label: "Edge shift, 95 %", help: "95 in 100 points of the edges are no farther off; pixels", say: pixels },
  rmse_one_receiver: { label: "Error on one face", help: "Root mean square over pixels that show a single triangle", say: part },
  wrong_samples: { label: "Wrong samples", help: "Bits of the shadow masks that differ", say: count },
  identified_fraction: { label: "Triangles found", help: "Of those that a light sees in a texel, the part that its list names; mean", say: percent },
  identified_pooled: { label: "Triangles found, pooled", help: "The same over all texels together", say: percent },
  texels_over_4: { label: "Texels with over 4", help: "In which more than four triangles are seen", say: count },
  receivers: { label: "Receivers", help: "Pixels that face a light", say: count },
  "reference.ms": { label: "Reference took", help: "To trace the truth", say: (ms) => `${ms.toFixed(0)} ms` },
};
// Told elsewhere on the page, or about the run and not the error.
const PASSED_OVER = /^(frames|visibility_ms|boundary\.(pixels|edge_shift_max)|reference\.\w+)$/;
const OBJECTS = ["boundary", "reference"];

// "boundary.rmse" and the like, numbers alone.
function flatten(figures: Comparison): Map<string, number> {
  const flat = new Map<string, number>();
  for (const [key, value] of Object.entries(figures)) {
    if (typeof value === "number") flat.set(key, value);
    else if (OBJECTS.includes(key) && value && typeof value === "object")
      for (const [inner, number] of Object.entries(value)) if (typeof number === "number") flat.set(`${key}.${inner}`, number);
  }
  return flat;
}

function rowsOf(figures: Comparison): [string, Row, number][] {
  const flat = flatten(figures);
  const known = Object.keys(ROWS).filter((key) => flat.has(key));
  const others = [...flat.keys()].filter((key) => !(key in ROWS) && !PASSED_OVER.test(key));
  return [...known, ...others].map((key) => [key, ROWS[key] ?? { label: key.replace(/[_.]/g, " "), help: key, say: part }, flat.get(key)!]);
}

export class ComparePanel {
  isStale = true;
  private readonly model = { against: "point", live: false, shows: true };
  private readonly button: Controller;
  private readonly table = document.createElement("table");
  private last: Comparison | undefined;

  constructor(
    private readonly folder: GUI,
    hello: Hello,
    private readonly events: CompareEvents,
  ) {
    const systems = Object.fromEntries(hello.algorithms.map((a) => [a.title, a.name]));
    const against = folder.add(this.model, "against", { ...REFERENCES, ...systems }).onChange(() => this.stale());
    describe(against, "compare-against", "What the picture's shadows are held against");
    this.button = folder.add({ act: () => this.act() }, "act").name(MEASURE);
    describe(this.button, "compare-run", "Measures how wrong the shadows of this view are (m); while it runs, gives up");
    const live = folder.add(this.model, "live").name("measure when still").onChange((on: boolean) => on && this.isStale && this.events.run(this.against));
    describe(live, "compare-live", "Measures again each time the view comes to rest");
    const shows = folder.add(this.model, "shows").name("difference picture").onChange((on: boolean) => events.show(on));
    describe(shows, "compare-shows", "Over the view until something moves (e): orange where light leaks, blue where shadow is wrong; stronger is more");
    this.table.className = "compared";
    this.table.hidden = true;
    folder.$children.append(this.table);
  }

  get against(): string {
    return this.model.against;
  }

  get live(): boolean {
    return this.model.live;
  }

  get shows(): boolean {
    return this.model.shows;
  }

  act(): void {
    this.folder.open();
    if (this.running) this.events.cancel();
    else this.events.run(this.against);
  }

  // Undefined: nothing runs.
  progress(text: string | undefined): void {
    this.button.name(text === undefined ? MEASURE : `Cancel (${text})`);
    this.button.domElement.dataset["running"] = String(text !== undefined);
  }

  stale(): void {
    this.isStale = true;
    this.table.classList.add("stale");
  }

  // With the figures before beside them: what a parameter does is the difference.
  take(figures: Comparison): void {
    const before = this.last && new Map(rowsOf(this.last).map(([key, row, value]) => [key, row.say(value)]));
    const head = this.table.createTHead();
    head.replaceChildren();
    const names = head.insertRow();
    const last = this.last && (this.last.algorithm === figures.algorithm ? "before" : this.last.algorithm);
    for (const text of ["", figures.algorithm, last ?? ""]) names.append(Object.assign(document.createElement("th"), { textContent: text, scope: "col" }));
    const body = document.createElement("tbody");
    for (const [key, row, value] of rowsOf(figures)) {
      const line = body.insertRow();
      line.dataset["figure"] = key;
      line.title = row.help;
      line.append(Object.assign(document.createElement("th"), { textContent: row.label, scope: "row" }));
      line.insertCell().textContent = row.say(value);
      line.insertCell().textContent = before?.get(key) ?? "";
    }
    this.table.tBodies[0]?.remove();
    this.table.append(body);
    this.table.hidden = false;
    this.table.classList.remove("stale");
    this.isStale = false;
    this.last = figures;
  }

  private get running(): boolean {
    return this.button.domElement.dataset["running"] === "true";
  }
}
