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

/** The handle (`reach-me`) at a place of the window, whatever is drawn above it: the one whose middle
    is nearest, where several overlap.
 * @type {(svg: SVGSVGElement, x: number, y: number) => Element | null} */
function handleAt(svg, x, y) {
  const there = document
    .elementsFromPoint(x, y)
    .filter((one) => one.classList.contains("reach-me") && svg.contains(one));
  const small = there.filter((one) => one instanceof SVGCircleElement);
  return (
    leastBy(small, (one) => Math.hypot(...minus(middleOnScreen(one), [x, y]))) ?? there[0] ?? null
  );
}

/** @type {(part: Element) => Point} */
function middleOnScreen(part) {
  const { left, top, width, height } = part.getBoundingClientRect();
  return [left + width / 2, top + height / 2];
}

/** Drag from a handle, or with a mouse from anywhere; a tap moves at once. A handle stays where it is
    under a finger, and comes to a mouse. `take` hears which one is taken. A finger beside the handles
    scrolls the page.
 * @type {(svg: SVGSVGElement, move: (pixel: Point, handle: Element | null) => void, take?: (pixel: Point, handle: Element | null) => void) => void} */
function draggable(svg, move, take = () => {}) {
  /** @type {number | null} */
  let held = null;
  /** @type {Element | null} */
  let handle = null;
  let grip = [0, 0]; // from a handle's middle to the hand
  // Browsers do not honour `touch-action` on a part of a picture: here the page is kept still.
  svg.addEventListener(
    "touchstart",
    (event) => {
      const [{ clientX, clientY }] = event.touches;
      const onHandle = event.touches.length === 1 && handleAt(svg, clientX, clientY);
      if (onHandle && event.cancelable) event.preventDefault();
    },
    { passive: false },
  );
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || held !== null) return;
    const { clientX, clientY, pointerType, pointerId } = event;
    handle = handleAt(svg, clientX, clientY);
    if (pointerType !== "mouse" && !handle) return;
    held = pointerId;
    svg.setPointerCapture(pointerId);
    svg.focus({ preventScroll: true });
    event.preventDefault();
    grip = [0, 0];
    if (handle instanceof SVGCircleElement && pointerType !== "mouse")
      grip = minus([clientX, clientY], middleOnScreen(handle));
    take(pixelOf(svg, event), handle);
    if (!handle) move(pixelOf(svg, event), null);
  });
  svg.addEventListener("pointermove", (event) => {
    if (event.pointerId === held) move(minus(pixelOf(svg, event), grip), handle);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    svg.addEventListener(name, (event) => {
      if (event instanceof PointerEvent && event.pointerId === held) held = null;
    });
  }
  svg.addEventListener("click", (event) => {
    if (!(event instanceof PointerEvent) || event.pointerType === "mouse") return;
    if (!handleAt(svg, event.clientX, event.clientY)) move(pixelOf(svg, event), null);
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
