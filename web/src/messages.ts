// What the page says: one line about the connection, one for errors and notes.
import { CANCELLED, type Progress, RpcError } from "./client.js";
import type { Status } from "./connection.js";

const NOTE_MS = 5000;

export class Messages {
  private stop: (() => void) | undefined; // of what goes on now
  private readonly cancel: HTMLButtonElement;
  private hide: ReturnType<typeof setTimeout> | undefined;
  private countdown: ReturnType<typeof setInterval> | undefined;
  private readonly text: HTMLElement;
  private readonly field: HTMLElement;

  constructor(
    private readonly message: HTMLElement,
    private readonly status: HTMLElement,
    private readonly retry: HTMLElement,
    private readonly token: HTMLElement,
  ) {
    this.text = message.querySelector("span")!;
    this.field = message.querySelector("code")!;
    this.cancel = message.querySelector<HTMLButtonElement>("button.cancel")!;
    this.cancel.addEventListener("click", () => this.stop?.());
    message.querySelector("button.dismiss")!.addEventListener("click", () => this.clear());
  }

  note(text: string, forMs = NOTE_MS): void {
    this.show(text, "", false);
    this.hide = setTimeout(() => this.clear(), forMs);
  }

  // Something goes on: stays until the next word. With `stop` it can be given up.
  busy(text: string, stop?: () => void): void {
    this.show(text, "", false, stop);
  }

  // What goes on, and how far it is by what the server tells.
  follow(what: string, stop?: () => void): (progress: Progress) => void {
    this.busy(what, stop);
    return ({ stage, done }) => this.busy(`${what} ${stage}${done ? ` ${Math.round(100 * done)} %` : ""}`, stop);
  }

  // Stays until dismissed or until something works. What was cancelled is no error where `cancelled` says so.
  error(error: unknown, cancelled?: string): void {
    if (cancelled && error instanceof RpcError && error.code === CANCELLED) {
      this.note(cancelled);
      return;
    }
    const field = error instanceof RpcError ? (error.data?.field ?? "") : "";
    this.show(error instanceof Error ? error.message : String(error), field, true);
  }

  clear(): void {
    clearTimeout(this.hide);
    this.stop = undefined;
    this.message.hidden = true;
  }

  connection(status: Status): void {
    clearInterval(this.countdown);
    this.status.dataset["state"] = status.state;
    this.retry.hidden = status.state !== "lost";
    if (status.state !== "connecting") this.token.hidden = !(status.state === "lost" && status.refused);
    if (status.state === "open") this.status.textContent = "Connected";
    else if (status.state === "connecting") this.status.textContent = "Connecting …";
    else this.lost(status);
  }

  private lost(status: Extract<Status, { state: "lost" }>): void {
    const why = status.reason || (status.code === 1006 ? "the server does not answer" : `closed with code ${status.code}`);
    const what = status.refused ? `Refused: ${status.refused}` : `Connection lost: ${why}`;
    const end = performance.now() + status.retryMs;
    const say = (): void => {
      const seconds = Math.ceil(Math.max(0, end - performance.now()) / 1000);
      this.status.textContent = `${what}. Trying again in ${seconds} s.`;
    };
    say();
    this.countdown = setInterval(say, 500);
  }

  private show(text: string, field: string, bad: boolean, stop?: () => void): void {
    clearTimeout(this.hide);
    this.stop = stop;
    this.cancel.hidden = !stop;
    this.text.textContent = text;
    this.field.textContent = field;
    this.field.hidden = field === "" || text.startsWith(field);
    this.message.classList.toggle("bad", bad);
    this.message.setAttribute("role", bad ? "alert" : "status");
    this.message.hidden = text === "";
  }
}
