/* What both pictures are made of: elements, scales, layers, names, a handle. */

const STACKED = 560; // in explorer.css, too: the width below which pictures are stacked
const SVG = "http://www.w3.org/2000/svg";

/** An element of a picture.
 * @template {keyof SVGElementTagNameMap} K
 * @param {K} name
 * @param {Record<string, string | number>} attributes
 * @param {string} text
 * @returns {SVGElementTagNameMap[K]} */
function make(name, attributes, text = "") {
  const element = document.createElementNS(SVG, name);
  set(element, attributes);
  element.textContent = text;
  return element;
}

/** @type {(element: Element, attributes: Record<string, string | number>) => void} */
function set(element, attributes) {
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
}

/** The height of a line of text: it differs from font to font.
 * @type {(svg: SVGSVGElement) => number} */
function lineHeight(svg) {
  const probe = svg.appendChild(make("text", {}, "0"));
  const { height } = probe.getBBox();
  probe.remove();
  return height;
}

/** The width of a word as the picture writes it.
 * @type {(svg: SVGSVGElement, text: string) => number} */
function wordWidth(svg, text) {
  const probe = svg.appendChild(make("text", {}, text));
  const { width } = probe.getBBox();
  probe.remove();
  return width;
}

/** A picture with two scales: `at` leads from values to pixels, `from` back.
 * @type {(svg: SVGSVGElement, ranges: number[][], margin: Picture["box"], equal: boolean) => Picture} */
function picture(svg, ranges, margin, equal) {
  const width = Math.max(240, Math.round(svg.getBoundingClientRect().width));
  const height = Math.round(Math.min(width, 560, largestHeight(svg)));
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("height", String(height));
  const [[x0, x1], [y0, y1]] = ranges;
  const [w, h] = [width - margin.left - margin.right, height - margin.top - margin.bottom];
  let [a, b] = [w / (x1 - x0), h / (y1 - y0)];
  if (equal) a = b = Math.min(a, b);
  const left = margin.left + (w - a * (x1 - x0)) / 2;
  const top = margin.top + (h - b * (y1 - y0)) / 2;
  return {
    svg,
    width,
    height,
    box: { left, top, right: left + a * (x1 - x0), bottom: top + b * (y1 - y0) },
    at: ([x, y]) => [left + a * (x - x0), top + b * (y1 - y)],
    from: ([x, y]) => [x0 + (x - left) / a, y1 - (y - top) / b],
  };
}

/** An empty picture of the plane, with equal scales: it shows what lies in its margin, too.
 * @type {(svg: SVGSVGElement, ranges: number[][], bottom?: number) => Picture} */
function wholePicture(svg, ranges, bottom = 8) {
  const fitted = picture(svg, ranges, { left: 8, right: 8, top: 8, bottom }, true);
  const box = { left: 0, top: 0, right: fitted.width, bottom: fitted.height };
  const drawn = { ...fitted, box };
  clear(drawn);
  return drawn;
}

/** Where pictures stand one below the other, two of them and a line of words fit the screen.
 * @type {(svg: SVGSVGElement) => number} */
function largestHeight(svg) {
  const stage = svg.closest(".stage");
  const stacked = stage !== null && stage.clientWidth <= STACKED;
  const screen = Math.min(window.innerHeight, window.screen.height); // a frame may be taller
  return stacked ? Math.max(200, (screen - 200) / 2) : Infinity;
}

/** @type {(points: Point[], closed?: boolean) => string} */
function pathText(points, closed = false) {
  const text = points.map(([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`).join("L");
  return points.length ? `M${text}${closed ? "Z" : ""}` : "";
}

/** A clipped layer inside a picture's box.
 * @type {(drawn: Picture, name: string, clipped?: boolean) => SVGGElement} */
function layer(drawn, name, clipped = true) {
  const group = make(
    "g",
    clipped ? { class: name, "clip-path": `url(#${drawn.svg.id}-clip)` } : { class: name },
  );
  drawn.svg.append(group);
  return group;
}

/** @type {(drawn: Picture) => void} */
function clear(drawn) {
  drawn.svg.replaceChildren();
  const { left, top, right, bottom } = drawn.box;
  const clip = make("clipPath", { id: `${drawn.svg.id}-clip` });
  clip.append(make("rect", { x: left, y: top, width: right - left, height: bottom - top }));
  drawn.svg.append(clip);
}

/** A boundary's own colour, the same in every figure; of a seventh one and more that of the region.
 * @type {(robot: Robot, name: string) => string} */
function boundaryColour(robot, name) {
  const k = robot.boundaries.findIndex((wall) => wall.name === name);
  return k >= 0 && k < 7 ? `var(--boundary-${k + 1})` : "var(--feasible)";
}

/** Let an element show a boundary: it has its colour, and its name to be found by.
 * @template {SVGElement | HTMLElement} T
 * @param {Robot} robot
 * @param {T} element
 * @param {string} name
 * @returns {T} */
function ownColour(robot, element, name) {
  element.dataset.boundary = name;
  element.style.setProperty("--own", boundaryColour(robot, name));
  return element;
}

/** A joint's name as it is printed: q1 is a letter with an index.
 * @type {(name: string) => string} */
function symbol(name) {
  return /^[a-z]\d+$/.test(name)
    ? name.replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[Number(digit)])
    : name;
}

/** The axes of two joint values: a grid with numbers, and beside it names with units.
 * @type {(drawn: Picture, axes: JointAxis[]) => void} */
function drawAxes(drawn, axes) {
  const group = layer(drawn, "axes", false);
  const line = lineHeight(drawn.svg);
  const { left, top, right, bottom } = drawn.box;
  const below = bottom + 4 + line;
  for (const [k, { name, unit, ticks: marks }] of axes.entries()) {
    for (const { value, text } of marks) {
      const [x, y] = drawn.at([value, value]);
      const middle = Math.min(x, drawn.width - 2 - wordWidth(drawn.svg, text) / 2);
      const ends =
        k === 0 ? { x1: x, x2: x, y1: top, y2: bottom } : { x1: left, x2: right, y1: y, y2: y };
      const at =
        k === 0
          ? { x: middle, y: below, "text-anchor": "middle" }
          : { x: left - 6, y: y + 4, "text-anchor": "end" };
      group.append(make("line", { class: "grid", ...ends }), make("text", at, text));
    }
    const [x, y] = k === 0 ? [(left + right) / 2, below + line] : [line - 2, (top + bottom) / 2];
    const title = make("text", { class: "axis-title", x, y, "text-anchor": "middle" });
    if (k === 1) title.setAttribute("transform", `rotate(-90 ${x} ${y})`);
    title.append(make("tspan", { class: "symbol" }, symbol(name)), ` / ${unit}`);
    group.append(title);
  }
}

/** Random poses: round dots where feasible (grey where cut off from home), crosses where not.
 * @type {(group: SVGGElement, sample: SamplePose[], place: (one: SamplePose) => Point) => void} */
function drawMarks(group, sample, place) {
  const d = { dots: "", "dots away": "", crosses: "" };
  for (const one of sample) {
    const [x, y] = place(one).map((value) => Number(value.toFixed(1)));
    if (one.safe) d[one.home ? "dots" : "dots away"] += `M${x} ${y}h0`;
    else d.crosses += `M${x - 2} ${y - 2}l4 4m0 -4l-4 4`;
  }
  for (const [name, text] of Object.entries(d))
    group.append(make("path", { class: name, d: text }));
}

/** A handle to drag, with room around it for a finger.
 * @type {(svg: SVGSVGElement, mark: SVGElement) => Handle} */
function handle(svg, mark) {
  const group = make("g", { class: "handle-group" });
  const room = make("circle", { class: "reach-me", r: 24 });
  group.append(mark, room);
  svg.append(group);
  return { group, mark, room };
}

/** Keep names inside the picture, and leave out one that would cover another.
 * @type {(names: Iterable<SVGTextElement>, width: number) => void} */
function thin(names, width) {
  /** @type {DOMRect[]} */
  const kept = [];
  for (const name of names) {
    const { x, width: size } = name.getBBox();
    const shift = Math.max(0, 4 - x) - Math.max(0, x + size + 4 - width);
    name.setAttribute("x", String(Number(name.getAttribute("x")) + shift));
    const box = name.getBBox();
    /** @type {(other: DOMRect) => boolean} */
    const covers = (other) =>
      Math.abs(box.x + box.width / 2 - other.x - other.width / 2) < (box.width + other.width) / 2 &&
      Math.abs(box.y - other.y) < box.height - 2;
    if (kept.some(covers)) name.remove();
    else kept.push(box);
  }
}

/** @type {Record<string, string>} */
const LEGEND_SHAPES = {
  singular: "M0 7H22",
  arc: "M0 7H22",
  polygon: "M1 12L11 2L21 12Z",
  dots: "M5 7h0M15 7h0",
  "dots away": "M5 7h0M15 7h0",
  ground: "M0 3H22V14H0Z",
  beyond: "M0 3H22M2 9l6 -6M8 9l6 -6M14 9l6 -6",
  crosses: "M9 5l4 4m0 -4l-4 4",
};

/** What a legend shows beside a text.
 * @type {(name: string, d: string, height?: number) => SVGSVGElement} */
function legendKey(name, d, height = 14) {
  const viewBox = `0 0 22 ${height}`;
  const key = make("svg", { width: 22, height, viewBox, "aria-hidden": "true" });
  for (const part of name === "workspace twice" ? [0, 1] : [0])
    key.append(make("path", { class: name, d, "data-part": part }));
  return key;
}

/** One line of a legend, or none.
 * @type {(name: string, text: string, shows: boolean) => HTMLLIElement[]} */
function legend(name, text, shows) {
  if (!shows) return [];
  const key = legendKey(name, LEGEND_SHAPES[name] ?? "M0 0H22V14H0Z");
  return [element("li", {}, key, text)];
}
