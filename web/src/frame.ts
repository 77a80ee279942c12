// A frame as it comes over the wire: proto/frame_header.h.

export const HEADER_SIZE = 64;
export const FLAG_KEY = 1;
export const FLAG_STILL = 2;
export const FLAG_LOSSLESS = 4;
export const CODECS = ["jpeg", "png", "webp", "exr"] as const;

export interface Frame {
  kind: number;
  codec: string;
  flags: number;
  algorithm: number; // index in server.hello's algorithms
  view: number;
  frame: number;
  inputTimeUs: number; // 0: shows no input of ours
  inputSeq: number;
  width: number;
  height: number;
  renderUs: number;
  encodeUs: number;
  requestId: number;
  payload: Uint8Array;
  receivedUs: number; // on this client's clock
}

export function parseFrame(data: ArrayBuffer, receivedUs = 0): Frame {
  if (data.byteLength < HEADER_SIZE) throw new Error(`a frame of ${data.byteLength} bytes is shorter than its header`);
  const v = new DataView(data);
  const magic = String.fromCharCode(v.getUint8(0), v.getUint8(1), v.getUint8(2), v.getUint8(3));
  if (magic !== "GNMF" || v.getUint8(4) !== 1) throw new Error(`not a frame of version 1: ${JSON.stringify(magic)} ${v.getUint8(4)}`);
  return {
    kind: v.getUint8(6),
    codec: CODECS[v.getUint8(7)] ?? `codec ${v.getUint8(7)}`,
    flags: v.getUint16(8, true),
    algorithm: v.getUint16(10, true),
    view: v.getUint32(12, true),
    frame: Number(v.getBigUint64(16, true)),
    inputTimeUs: Number(v.getBigUint64(24, true)),
    inputSeq: v.getUint32(32, true),
    width: v.getUint16(36, true),
    height: v.getUint16(38, true),
    renderUs: v.getUint32(40, true),
    encodeUs: v.getUint32(44, true),
    requestId: v.getUint32(48, true),
    payload: new Uint8Array(data, v.getUint8(5)),
    receivedUs,
  };
}
