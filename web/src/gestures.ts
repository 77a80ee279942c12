// Pointer, wheel and touch on the picture, as turns, pans and zooms.

export interface Gestures {
  turn(dx: number, dy: number): void; // fractions of the element's height
  pan(dx: number, dy: number): void;
  zoom(factor: number): void;
}

interface Point {
  x: number;
  y: number;
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
  const move = (event: PointerEvent): void => {
    if (!down.has(event.pointerId)) return;
    const before = [...down.values()];
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const after = [...down.values()];
    const dx = (middle(after).x - middle(before).x) / element.clientHeight;
    const dy = (middle(after).y - middle(before).y) / element.clientHeight;
    const panning = after.length > 1 || event.shiftKey || (event.buttons & 6) !== 0;
    if (panning) gestures.pan(dx, dy);
    else gestures.turn(dx, dy);
    if (after.length > 1 && spread(after) > 0) gestures.zoom(spread(before) / spread(after));
  };
  const lift = (event: PointerEvent): void => void down.delete(event.pointerId);
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    down.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  element.addEventListener("pointermove", move);
  element.addEventListener("pointerup", lift);
  element.addEventListener("pointercancel", lift);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 16 : 1;
      gestures.zoom(Math.exp(Math.max(-200, Math.min(200, event.deltaY * lines)) * 0.0015));
    },
    { passive: false },
  );
}
