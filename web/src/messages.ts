// What the page says: one line about the connection, one for errors and notes.
import { RpcError } from "./client.js";
import type { Status } from "./connection.js";

const NOTE_MS = 5000;

export class Messages {
  waiting = false;
  private hide: ReturnType<typeof setTimeout> | undefined;
  private countdown: ReturnType<typeof setInterval> | undefined;
  private readonly text: HTMLElement;
  private readonly field: HTMLElement;

  constructor(
    private readonly message: HTMLElement,
    private readonly status: HTMLElement,
    private readonly retry: HTMLElement,
  ) {
    this.text = message.querySelector("span")!;
    this.field = message.querySelector("code")!;
    message.querySelector("button")!.addEventListener("click", () => this.clear());
  }

  // A note that is kept stands for something that goes on.
  note(text: string, keep = false): void {
    this.show(text, "", false);
    this.waiting = keep;
    if (!keep) this.hide = setTimeout(() => this.clear(), NOTE_MS);
  }

  // Stays until dismissed or until something works.
  error(error: unknown): void {
    const field = error instanceof RpcError ? (error.data?.field ?? "") : "";
    this.waiting = false;
    this.show(error instanceof Error ? error.message : String(error), field, true);
  }

  clear(): void {
    clearTimeout(this.hide);
    this.waiting = false;
    this.message.hidden = true;
  }

  connection(status: Status): void {
    clearInterval(this.countdown);
    this.status.dataset["state"] = status.state;
    this.retry.hidden = status.state !== "lost";
    if (status.state === "open") this.status.textContent = "Connected";
    else if (status.state === "connecting") this.status.textContent = "Connecting …";
    else this.lost(status);
  }

  private lost(status: Extract<Status, { state: "lost" }>): void {
    const why = status.reason || (status.code === 1006 ? "the server does not answer" : `closed with code ${status.code}`);
    const end = performance.now() + status.retryMs;
    const say = (): void => {
      const seconds = Math.ceil(Math.max(0, end - performance.now()) / 1000);
      this.status.textContent = `Connection lost: ${why}. Trying again in ${seconds} s.`;
    };
    say();
    this.countdown = setInterval(say, 500);
  }

  private show(text: string, field: string, bad: boolean): void {
    clearTimeout(this.hide);
    this.text.textContent = text;
    this.field.textContent = field;
    this.field.hidden = field === "" || text.startsWith(field);
    this.message.classList.toggle("bad", bad);
    this.message.setAttribute("role", bad ? "alert" : "status");
    this.message.hidden = text === "";
  }
}
