// Pointer, wheel and touch on the picture, as turns, pans and zooms.

// Lengths are fractions of the element's height; `timeUs` is when the hand moved, on the page's clock.
export interface Gestures {
  turn(dx: number, dy: number, timeUs: number): void;
  pan(dx: number, dy: number, timeUs: number): void;
  zoom(factor: number, x: number, y: number, timeUs: number): void; // about (x, y) from the middle
}

interface Point {
  x: number;
  y: number;
}

export const eventUs = (event: Event): number => Math.round((performance.timeOrigin + event.timeStamp) * 1000);

// pointermove waits for the screen's next refresh; pointerrawupdate, where there is one (secure pages of some browsers, not for every pointer),
// does not. Who listens to both gets the same place twice.
export function listenMoves(element: HTMLElement, moved: (event: PointerEvent) => void): void {
  for (const name of ["pointerrawupdate", "pointermove"]) element.addEventListener(name, moved as EventListener);
}

const middle = (points: Point[]): Point => ({
  x: points.reduce((sum, p) => sum + p.x, 0) / points.length,
  y: points.reduce((sum, p) => sum + p.y, 0) / points.length,
});
const spread = (points: Point[]): number => {
  const [a, b] = points;
  return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
};

export function listen(element: HTMLElement, gestures: Gestures): void {
  const down = new Map<number, Point>();
  const fromMiddle = (point: Point): Point => {
    const box = element.getBoundingClientRect();
    return { x: (point.x - box.left - box.width / 2) / box.height, y: (point.y - box.top - box.height / 2) / box.height };
  };
  const move = (event: PointerEvent): void => {
    if (!down.has(event.pointerId)) return;
    const before = [...down.values()];
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const after = [...down.values()];
    const at = middle(after), timeUs = eventUs(event);
    const dx = (at.x - middle(before).x) / element.clientHeight;
    const dy = (at.y - middle(before).y) / element.clientHeight;
    if (dx === 0 && dy === 0 && spread(after) === spread(before)) return;
    const panning = after.length > 1 || event.shiftKey || (event.buttons & 6) !== 0;
    if (panning) gestures.pan(dx, dy, timeUs);
    else gestures.turn(dx, dy, timeUs);
    const { x, y } = fromMiddle(at);
    if (after.length > 1 && spread(after) > 0) gestures.zoom(spread(before) / spread(after), x, y, timeUs);
  };
  const lift = (event: PointerEvent): void => void down.delete(event.pointerId);
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  listenMoves(element, move);
  element.addEventListener("pointerup", lift);
  element.addEventListener("pointercancel", lift);
  element.addEventListener("lostpointercapture", lift);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 16 : 1;
      const pinch = event.ctrlKey ? 6 : 1; // how browsers tell two fingers on a touchpad
      const factor = Math.exp(Math.max(-200, Math.min(200, event.deltaY * lines * pinch)) * 0.0015);
      const { x, y } = fromMiddle({ x: event.clientX, y: event.clientY });
      gestures.zoom(factor, x, y, eventUs(event));
    },
    { passive: false },
  );
}
