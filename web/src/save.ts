// A picture as a download.
import type { Frame } from "./frame.js";

const clean = (text: string): string => text.replace(/^builtin:/, "").replace(/[^A-Za-z0-9.=-]+/g, "-").slice(0, 60);
const extension = (codec: string): string => (codec === "jpeg" ? "jpg" : codec);

// Returns the name it was given.
export function saveFrame(frame: Frame, parts: string[]): string {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([frame.payload as BlobPart], { type: `image/${frame.codec}` }));
  link.download = `gnomon-${parts.map(clean).join("-")}.${extension(frame.codec)}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000); // the download has taken it by then
  return link.download;
}
