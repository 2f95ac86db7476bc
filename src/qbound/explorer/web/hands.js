/* What hands do with a picture: drag, tap, press a key. */

/** @type {Record<string, number[]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** Where a pointer is, in a picture's own pixels.
 * @type {(svg: SVGSVGElement, event: MouseEvent) => Point} */
function pixelOf(svg, event) {
  const box = svg.getBoundingClientRect();
  const view = svg.viewBox.baseVal;
  return [
    ((event.clientX - box.left) * view.width) / box.width,
    ((event.clientY - box.top) * view.height) / box.height,
  ];
}

/** Drag from a handle (`reach-me`), or with a mouse from anywhere; a tap moves at once.
 * @type {(svg: SVGSVGElement, move: (pixel: Point, handle: Element | null) => void) => void} */
function draggable(svg, move) {
  /** @type {number | null} */
  let held = null;
  /** @type {Element | null} */
  let handle = null;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const { target, pointerType, pointerId } = event;
    handle = target instanceof Element && target.classList.contains("reach-me") ? target : null;
    if (pointerType === "touch" && !handle) return;
    held = pointerId;
    svg.setPointerCapture(pointerId);
    svg.focus({ preventScroll: true });
    event.preventDefault();
    if (!handle) move(pixelOf(svg, event), null);
  });
  svg.addEventListener("pointermove", (event) => {
    if (event.pointerId === held) move(pixelOf(svg, event), handle);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    svg.addEventListener(name, () => {
      held = null;
    });
  }
  svg.addEventListener("click", (event) => {
    if (event instanceof PointerEvent && event.pointerType === "touch" && !handle)
      move(pixelOf(svg, event), null);
    handle = null;
  });
}

/** Arrow keys step; other keys do what `keys` names.
 * @type {(svg: SVGElement, step: (direction: number[], large: boolean) => void, keys?: Record<string, () => void>) => void} */
function onKeys(svg, step, keys = {}) {
  svg.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    if (ARROWS[event.key]) step(ARROWS[event.key], event.shiftKey);
    else if (keys[key]) keys[key]();
    else return;
    event.preventDefault();
  });
}
