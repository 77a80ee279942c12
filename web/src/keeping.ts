// Taking things away: pictures rendered at their own size, and commands and links that show the same again.
import type { Client } from "./client.js";
import type { Messages } from "./messages.js";
import type { Shared, Snapshot } from "./panel.js";
import { saveFrame } from "./save.js";
import { compareCommand, curlCommand, renderCommand, type Shown } from "./words.js";

export interface KeepingEvents {
  client(): Client | undefined;
  shown(): Shown | undefined;
  against(): string; // what a comparison is with
  link(): string;
}

const COPIED_SHOWN = 150; // letters

export class Keeping {
  constructor(
    private readonly events: KeepingEvents,
    private readonly messages: Messages,
    private readonly dialog: HTMLDialogElement,
  ) {}

  async save({ width, height, format, aa, quality }: Snapshot): Promise<void> {
    const client = this.events.client(), shown = this.events.shown();
    if (!client || !shown) return;
    const size: [number, number] = [Math.round(width), Math.round(height)];
    const own = new AbortController();
    const progress = this.messages.follow(`Rendering ${size[0]} × ${size[1]} …`, () => own.abort());
    try {
      const frame = await client.snapshot({ ...shown, size, format, aa, ...(quality && { quality }) }, { signal: own.signal, progress });
      const name = saveFrame(frame, [shown.scene, shown.algorithm]);
      this.messages.note(`Saved ${name}: ${frame.width} × ${frame.height}, ${(frame.payload.length / 1024).toFixed(0)} KiB`);
    } catch (error) {
      this.messages.error(error, "The picture was cancelled");
    }
  }

  async share(what: Shared): Promise<void> {
    const shown = this.events.shown();
    if (!shown) return;
    const text = this.text(what, shown);
    if (await this.copy(text)) this.messages.note(`Copied: ${text.length > COPIED_SHOWN ? `${text.slice(0, COPIED_SHOWN)} …` : text}`);
  }

  private text(what: Shared, shown: Shown): string {
    const server = new URL("/", location.href).href;
    if (what === "link") return this.events.link();
    if (what === "render") return renderCommand(shown, shown.scene.startsWith("builtin:") ? undefined : server);
    if (what === "compare") return compareCommand(shown, this.events.against());
    return curlCommand(shown, server, location.search.includes("token="));
  }

  // Where the browser keeps pages away from the clipboard (no secure context), into a box to be copied by hand.
  private async copy(text: string): Promise<boolean> {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      const field = this.dialog.querySelector("textarea")!;
      field.value = text;
      this.dialog.showModal();
      field.select();
      return false;
    }
  }
}
