// What each frame took, for the chart and for whoever measures: a ring of the newest.
import type { Frame } from "./frame.js";

export interface FrameTiming {
  frame: number;
  seconds: number; // of the page's life, when drawn
  renderMs: number;
  encodeMs: number;
  decodeMs: number; // from the message's arrival to the picture in memory
  drawMs: number;
  inputMs: number | null; // from the input's event to its message
  transferMs: number | null; // from there to the frame's message, without rendering and encoding: sockets and queues
  photonMs: number | null; // from the input's event to the return of the draw call; null: answers no input
  still: boolean;
  inputSeq: number;
  bytes: number;
  width: number;
  height: number;
}

const KEPT = 600;

export class Timings {
  readonly frames: FrameTiming[] = [];

  add(timing: FrameTiming): void {
    this.frames.push(timing);
    if (this.frames.length > 2 * KEPT) this.frames.splice(0, KEPT);
  }

  get last(): FrameTiming | undefined {
    return this.frames.at(-1);
  }

  // Of the newest `count` that have it.
  median(of: (timing: FrameTiming) => number | null, count = 31): number | undefined {
    const values: number[] = [];
    for (let i = this.frames.length; i-- > 0 && values.length < count; ) {
      const value = of(this.frames[i]!);
      if (value !== null) values.push(value);
    }
    return values.sort((a, b) => a - b)[values.length >> 1];
  }
}

export function timeFrame(frame: Frame, decodedUs: number, drawnUs: number, sentUs: number | undefined): FrameTiming {
  const answers = sentUs !== undefined;
  return {
    frame: frame.frame,
    seconds: performance.now() / 1000,
    renderMs: frame.renderUs / 1000,
    encodeMs: frame.encodeUs / 1000,
    decodeMs: (decodedUs - frame.receivedUs) / 1000,
    drawMs: (drawnUs - decodedUs) / 1000,
    inputMs: answers ? (sentUs - frame.inputTimeUs) / 1000 : null,
    transferMs: answers ? (frame.receivedUs - sentUs - frame.renderUs - frame.encodeUs) / 1000 : null,
    photonMs: answers ? (drawnUs - frame.inputTimeUs) / 1000 : null,
    still: (frame.flags & 2) !== 0,
    inputSeq: frame.inputSeq,
    bytes: frame.payload.length,
    width: frame.width,
    height: frame.height,
  };
}
