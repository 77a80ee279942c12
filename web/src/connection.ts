// A client that comes back: connects again after a loss, with a growing delay. Knows nothing of pages.
import { Client, type ClientEvents, type SocketClass } from "./client.js";

export type Status = { state: "connecting" } | { state: "open" } | { state: "lost"; code: number; reason: string; retryMs: number; attempts: number; refused: string };

export interface ConnectionEvents extends Omit<ClientEvents, "closed"> {
  status?(status: Status): void;
  // Why a connection was closed before the server spoke, where that can be found out: "" if not. Browsers do not tell of a refused upgrade.
  explain?(): Promise<string>;
}

const FIRST_MS = 250;
const LONGEST_MS = 8000;
const SILENCE_MS = 15000; // an open view has word each second; a network that swallows everything does not close the socket

export class Connection {
  client: Client | undefined;
  private attempts = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private watch: ReturnType<typeof setInterval> | undefined;
  private ended = false;
  private refused = ""; // what the last refusal was for, while nothing else is known

  constructor(
    private readonly url: string,
    private readonly events: ConnectionEvents,
    private readonly socketClass?: SocketClass,
  ) {
    this.connect();
  }

  retry(): void {
    if (this.timer !== undefined) this.connect();
  }

  close(): void {
    this.ended = true;
    clearTimeout(this.timer);
    clearInterval(this.watch);
    this.client?.close();
  }

  private connect(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.events.status?.({ state: "connecting" });
    let greeted = false;
    const client = new Client(
      this.url,
      {
        ...this.events,
        hello: (hello) => {
          this.attempts = 0;
          greeted = true;
          this.events.status?.({ state: "open" });
          this.events.hello?.(hello);
        },
        closed: (code, reason) => this.lose(code, reason, greeted),
      },
      this.socketClass,
    );
    this.client = client;
    this.watch = setInterval(() => {
      if (client.silentMs > SILENCE_MS) client.abandon(`silent for ${SILENCE_MS / 1000} s`);
    }, 1000);
  }

  private lose(code: number, reason: string, greeted: boolean): void {
    clearInterval(this.watch);
    this.client = undefined;
    if (this.ended) return;
    // The spread keeps a server's clients from coming back all at once.
    const retryMs = Math.round(Math.min(LONGEST_MS, FIRST_MS * 2 ** this.attempts++) * (0.8 + 0.4 * Math.random()));
    this.timer = setTimeout(() => this.connect(), retryMs);
    if (greeted) this.refused = "";
    const lost = { state: "lost", code, reason, retryMs, attempts: this.attempts } as const;
    this.events.status?.({ ...lost, refused: this.refused });
    if (!greeted) void this.explain(lost);
  }

  private async explain(lost: Omit<Extract<Status, { state: "lost" }>, "refused">): Promise<void> {
    const { timer, refused } = this;
    this.refused = (await this.events.explain?.().catch(() => "")) ?? "";
    if (this.refused !== refused && this.timer === timer) this.events.status?.({ ...lost, refused: this.refused });
  }
}
