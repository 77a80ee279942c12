// The connection: requests, notifications, frames and their acknowledgement. Knows nothing of pages; scripts may import it.
import { type Frame, parseFrame } from "./frame.js";
import type {
  CompareSettings, Comparison, Hello, Light, LightsResult, Progress, SceneChanged, SnapshotSettings, ViewInfo, ViewSettings, ViewStats,
} from "./protocol.js";

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
  viewError?(error: { view: number; code: number; message: string; data?: { field?: string } | null }): void;
  sceneChanged?(change: SceneChanged): void;
  // Any notification that has no callback of its own.
  notified?(method: string, params: unknown): void;
  closed?(code: number, reason: string): void;
}

export type SocketClass = new (url: string, protocols: string) => WebSocket;
interface Waiting {
  resolve(value: unknown): void;
  reject(error: Error): void;
  progress: ((progress: Progress) => void) | undefined;
}

export interface RequestOptions {
  signal?: AbortSignal; // aborted: the server is asked to give up, and the request then fails with CANCELLED
  progress?: (progress: Progress) => void;
}

// Given up by $/cancel: proto/README.md, Errors.
export const CANCELLED = -32007;

// Microseconds of this client's own clock, as sent with input and echoed by frames.
export const nowUs = (): number => Math.round((performance.timeOrigin + performance.now()) * 1000);

const SNAPSHOT_KIND = 1;
const DIFFERENCE_KIND = 2;

export class Client {
  private readonly socket: WebSocket;
  private readonly waiting = new Map<number, Waiting>();
  private lastId = 0;
  private lastInput = 0;
  private lastPicture = 0;
  private readonly pictures = new Map<number, Frame | undefined>(); // of requests under way
  private heardMs = Infinity;
  private gone = false;

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

  // As if the other end had closed, for one that no longer answers: a close of the socket would wait for it.
  abandon(reason: string): void {
    this.socket.close(4000);
    this.end(4000, reason);
  }

  get open(): boolean {
    return this.socket.readyState === 1 && !this.gone;
  }

  // Since the last message, once a view's statistics have come: they go on coming each second. 0 before.
  get silentMs(): number {
    return Math.max(0, performance.now() - this.heardMs);
  }

  request<T>(method: string, params: object = {}, { signal, progress }: RequestOptions = {}): Promise<T> {
    const id = ++this.lastId;
    return new Promise<T>((resolve, reject) => {
      if (!this.open || signal?.aborted) {
        reject(signal?.aborted ? new RpcError(CANCELLED, "given up") : new RpcError(0, "not connected"));
        return;
      }
      this.waiting.set(id, { resolve: resolve as (value: unknown) => void, reject, progress });
      this.socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
      signal?.addEventListener("abort", () => this.waiting.has(id) && this.notify("$/cancel", { id }), { once: true });
    });
  }

  notify(method: string, params: object): void {
    if (this.open) this.socket.send(JSON.stringify({ jsonrpc: "2.0", method, params }));
  }

  openView(settings: ViewSettings, options: RequestOptions = {}): Promise<ViewInfo> {
    return this.request<ViewInfo>("view.open", { ...settings, ...this.input() }, options);
  }

  setView(view: number, settings: ViewSettings): Promise<ViewInfo> {
    return this.request<ViewInfo>("view.set", { view, ...settings, ...this.input() });
  }

  // For what a person does with a mouse: sent at once, unanswered, with the time of the event. Returns the number that frames echo.
  steer(view: number, settings: ViewSettings, timeUs = nowUs()): number {
    this.notify("view.set", { view, ...settings, ...this.input(timeUs) });
    return this.lastInput;
  }

  steerLight(view: number, index: number, light: Partial<Light>, timeUs = nowUs()): number {
    this.notify("light.set", { view, index, light, ...this.input(timeUs) });
    return this.lastInput;
  }

  setLight(view: number, index: number, light: Partial<Light>): Promise<LightsResult> {
    return this.request<LightsResult>("light.set", { view, index, light, ...this.input() });
  }

  addLight(view: number, light: Light): Promise<LightsResult> {
    return this.request<LightsResult>("light.add", { view, light, ...this.input() });
  }

  removeLight(view: number, index: number): Promise<LightsResult> {
    return this.request<LightsResult>("light.remove", { view, index, ...this.input() });
  }

  // The newest input sent, so far.
  get inputSeq(): number {
    return this.lastInput;
  }

  // The picture comes before the answer.
  async snapshot(settings: SnapshotSettings, options: RequestOptions = {}): Promise<Frame> {
    const { frame } = await this.pictured("render.snapshot", settings, options);
    if (!frame) throw new RpcError(0, "the server answered without sending the picture");
    return frame;
  }

  // `frame` only where a difference picture was asked for.
  async compare(settings: CompareSettings, options: RequestOptions = {}): Promise<{ figures: Comparison; frame: Frame | undefined }> {
    const { result, frame } = await this.pictured<Comparison>("compare.run", settings, options);
    return { figures: result, frame };
  }

  private async pictured<T>(method: string, params: object, options: RequestOptions): Promise<{ result: T; frame: Frame | undefined }> {
    const requestId = ++this.lastPicture;
    this.pictures.set(requestId, undefined);
    try {
      const result = await this.request<T>(method, { ...params, request_id: requestId }, options);
      return { result, frame: this.pictures.get(requestId) };
    } finally {
      this.pictures.delete(requestId);
    }
  }

  ack(frame: Frame): void {
    this.notify("frame.ack", { view: frame.view, frame: frame.frame });
  }

  private input(timeUs = nowUs()): { input_seq: number; input_time_us: number } {
    this.lastInput = (this.lastInput + 1) >>> 0;
    return { input_seq: this.lastInput, input_time_us: timeUs };
  }

  private receive(data: string | ArrayBuffer): void {
    if (this.heardMs !== Infinity) this.heardMs = performance.now();
    if (typeof data !== "string") {
      void this.show(parseFrame(data, nowUs()));
      return;
    }
    const message = JSON.parse(data);
    if (message.method === undefined) this.settle(message);
    else if (message.method === "server.hello") this.events.hello?.(message.params);
    else if (message.method === "view.stats") {
      this.heardMs = performance.now();
      this.events.stats?.(message.params);
    } else if (message.method === "view.error") this.events.viewError?.(message.params);
    else if (message.method === "$/progress") this.waiting.get(message.params.id)?.progress?.(message.params);
    else if (message.method === "scene.changed") this.events.sceneChanged?.(message.params);
    else this.events.notified?.(message.method, message.params);
  }

  private async show(frame: Frame): Promise<void> {
    const asked = frame.kind === SNAPSHOT_KIND || frame.kind === DIFFERENCE_KIND;
    if (asked && this.pictures.has(frame.requestId)) this.pictures.set(frame.requestId, frame);
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
    if (this.gone) return;
    this.gone = true;
    for (const waiting of this.waiting.values()) waiting.reject(new RpcError(0, "the connection closed"));
    this.waiting.clear();
    this.events.closed?.(code, reason);
  }
}
