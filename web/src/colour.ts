// Linear light as the wire has it, to and from what a colour field shows.
import type { Vec3 } from "./protocol.js";

// IEC 61966-2-1.
const encode = (x: number): number => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const decode = (x: number): number => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);

// A colour brighter than 1 shows as its hue.
export function toHex(color: Vec3): string {
  const most = Math.max(1, ...color);
  return `#${color.map((c) => Math.round(255 * encode(c / most)).toString(16).padStart(2, "0")).join("")}`;
}

export function fromHex(hex: string): Vec3 {
  return [1, 3, 5].map((at) => Number(decode(parseInt(hex.slice(at, at + 2), 16) / 255).toFixed(4))) as Vec3;
}
