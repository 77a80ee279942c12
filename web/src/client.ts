// The connection: requests, notifications, frames and their acknowledgement. Knows nothing of pages; scripts may import it.
import { type Frame, parseFrame } from "./frame.js";
import type { Hello, ViewInfo, ViewSettings, ViewStats } from "./protocol.js";

export * from "./frame.js";
export type * from "./protocol.js";

export class RpcError extends Error {
  constructor(
    readonly code: number,
    message: string,
    readonly data?: { field?: string; limit?: string },
  ) {
    super(message);
  }
}

export interface ClientEvents {
  hello?(hello: Hello): void;
  // The frame counts as shown, and its credit returns, when the promise settles.
  frame?(frame: Frame): void | Promise<void>;
  stats?(stats: ViewStats): void;
  viewError?(error: { view: number; code: number; message: string }): void;
  closed?(code: number, reason: string): void;
}

type SocketClass = new (url: string, protocols: string) => WebSocket;
interface Waiting {
  resolve(value: unknown): void;
  reject(error: Error): void;
}

// Microseconds of this client's own clock, as sent with input and echoed by frames.
export const nowUs = (): number => Math.round((performance.timeOrigin + performance.now()) * 1000);

export class Client {
  private readonly socket: WebSocket;
  private readonly waiting = new Map<number, Waiting>();
  private lastId = 0;
  private lastInput = 0;

  constructor(
    url: string,
    private readonly events: ClientEvents,
    socketClass: SocketClass = WebSocket,
  ) {
    this.socket = new socketClass(url, "gnomon.v1");
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = (message) => this.receive(message.data as string | ArrayBuffer);
    this.socket.onclose = (event) => this.end(event.code, event.reason);
    this.socket.onerror = () => undefined; // the close that follows says all there is
  }

  close(): void {
    this.socket.close(1000);
  }

  get open(): boolean {
    return this.socket.readyState === 1;
  }

  request<T>(method: string, params: object = {}): Promise<T> {
    const id = ++this.lastId;
    return new Promise<T>((resolve, reject) => {
      if (!this.open) {
        reject(new RpcError(0, "not connected"));
        return;
      }
      this.waiting.set(id, { resolve: resolve as (value: unknown) => void, reject });
      this.socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    });
  }

  notify(method: string, params: object): void {
    if (this.open) this.socket.send(JSON.stringify({ jsonrpc: "2.0", method, params }));
  }

  openView(settings: ViewSettings): Promise<ViewInfo> {
    return this.request<ViewInfo>("view.open", { ...settings, ...this.input() });
  }

  // For what a person does with a mouse: sent at once, unanswered, time-stamped.
  steer(view: number, settings: ViewSettings): void {
    this.notify("view.set", { view, ...settings, ...this.input() });
  }

  setView(view: number, settings: ViewSettings): Promise<ViewInfo> {
    return this.request<ViewInfo>("view.set", { view, ...settings, ...this.input() });
  }

  ack(frame: Frame): void {
    this.notify("frame.ack", { view: frame.view, frame: frame.frame });
  }

  private input(): { input_seq: number; input_time_us: number } {
    this.lastInput = (this.lastInput + 1) >>> 0;
    return { input_seq: this.lastInput, input_time_us: nowUs() };
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data !== "string") {
      void this.show(parseFrame(data));
      return;
    }
    const message = JSON.parse(data);
    if (message.method === undefined) this.settle(message);
    else if (message.method === "server.hello") this.events.hello?.(message.params);
    else if (message.method === "view.stats") this.events.stats?.(message.params);
    else if (message.method === "view.error") this.events.viewError?.(message.params);
  }

  private async show(frame: Frame): Promise<void> {
    try {
      await this.events.frame?.(frame);
    } finally {
      if (frame.kind === 0) this.ack(frame);
    }
  }

  private settle(message: { id: number; result?: unknown; error?: { code: number; message: string; data?: object } }): void {
    const waiting = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.error) waiting?.reject(new RpcError(message.error.code, message.error.message, message.error.data));
    else waiting?.resolve(message.result);
  }

  private end(code: number, reason: string): void {
    for (const waiting of this.waiting.values()) waiting.reject(new RpcError(0, "the connection closed"));
    this.waiting.clear();
    this.events.closed?.(code, reason);
  }
}
