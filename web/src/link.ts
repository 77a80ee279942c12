// The address bar holds what is looked at, so that a link shows the same: #scene=...&algorithm=...&show=...
import type { ViewSettings } from "./protocol.js";

const KEYS = ["scene", "algorithm", "show"] as const;

export function readLink(): ViewSettings {
  const given = new URLSearchParams(location.hash.slice(1));
  const settings: ViewSettings = {};
  for (const key of KEYS) {
    const value = given.get(key);
    if (value) settings[key] = value;
  }
  return settings;
}

export function writeLink(settings: ViewSettings): void {
  const pairs = KEYS.filter((key) => settings[key]).map((key) => `${key}=${encodeURIComponent(settings[key]!).replace(/%(3A|2C|2F|3D)/g, decodeURIComponent)}`);
  history.replaceState(null, "", `${location.pathname}${location.search}#${pairs.join("&")}`);
}
