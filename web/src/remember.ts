// What a browser keeps between visits; where it keeps nothing for this page, that lasts as long as the page does.

export function remembered(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Then not.
  }
}
