// What test_book_browser.py asks of a page. Each question is answered with a list of what is wrong.

const FORMULA_ERROR = "mjx-merror, [data-mml-node=merror], mjx-container [fill=red]";
const TEX = /\\\(|\\\[|\$[^$]+\$|\\(frac|begin|mathbf|beta)/;

function openEverything() {
  for (const part of document.querySelectorAll("details")) part.open = true;
}

/** @type {(element: Element) => string} */
function beginning(element) {
  const formula = element.closest(".math");
  const words = formula?.getAttribute("data-words") ?? (formula ?? element).textContent ?? "";
  return words.trim().slice(0, 60);
}

// Two thirds of a chapter's elements are glyphs. A formula whose glyphs are gone keeps its size, and
// all else is laid out faster. What holds text is kept, and of all formulas the first few.
function emptyFormulas() {
  for (const formula of [...document.querySelectorAll(".math")].slice(5)) {
    formula.setAttribute("data-words", formula.textContent ?? "");
    for (const words of formula.querySelectorAll("mjx-assistive-mml")) words.replaceChildren();
    for (const glyphs of formula.querySelectorAll("mjx-container > svg"))
      if (!glyphs.querySelector("text")) glyphs.replaceChildren();
  }
}

// Axe looks at every part of a page: of what is made alike many times, a few stand for all.
function keepOneOfEachRow() {
  const kinds = new Set();
  for (const row of document.querySelectorAll(".ledger-table tbody tr")) {
    const { kind, verdict } = /** @type {HTMLElement} */ (row).dataset;
    if (kinds.has(kind) && kinds.has(verdict)) row.remove();
    kinds.add(kind).add(verdict);
  }
  for (const formula of [...document.querySelectorAll("mjx-container")].slice(5))
    formula.replaceChildren("x");
}

const MADE_ALIKE = "article :is(tbody tr, li, p, dl, pre, pre span, a, code, .math, .cell)";

// Colours hang on what an element is and lies in: the first three of each kind stand for all.
function keepThreeOfEachKind() {
  /** @type {(element: Element) => string} */
  const step = (e) => [e.localName, ...e.classList, e.getAttribute("style") ?? ""].join(".");
  /** @type {Map<Element, string>} */
  const paths = new Map();
  /** @type {(element: Element | null) => string} */
  const path = (e) => {
    if (!e) return "";
    const found = paths.get(e) ?? `${path(e.parentElement)}>${step(e)}`;
    paths.set(e, found);
    return found;
  };
  /** @type {Map<string, number>} */
  const counts = new Map();
  for (const element of document.querySelectorAll(MADE_ALIKE)) {
    const count = (counts.get(path(element)) ?? 0) + 1;
    counts.set(path(element), count);
    if (count > 3) element.remove();
  }
}

// Texts with the elements that hold them.
/** @type {(root: Node) => Generator<{ text: Text, element: Element }>} */
function* textsOf(root) {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  for (let text = walker.nextNode(); text; text = walker.nextNode())
    if (text instanceof Text && text.parentElement && text.data.trim())
      yield { text, element: text.parentElement };
}

function unshownFormulas() {
  const all = [...document.querySelectorAll(".math")];
  const bare = all.filter((formula) => !formula.querySelector("mjx-container"));
  const wrong = [...document.querySelectorAll(FORMULA_ERROR)];
  const raw = [...textsOf(document.querySelector(".bd-article") ?? document.body)]
    .filter(({ element }) => !element.closest("pre, code, script, style, mjx-container"))
    .filter(({ text }) => TEX.test(text.data));
  return [
    ...bare.map((formula) => `not typeset: ${beginning(formula)}`),
    ...wrong.map((part) => `an error in: ${beginning(part)}`),
    ...raw.map(({ text }) => `TeX in the text: ${text.data.trim().slice(0, 60)}`),
  ];
}

const THAT_MAY_BE_WIDE =
  ".bd-article :is(mjx-container > svg, table, pre, img, figure, p, li, dt, h1, h2, h3, .verdict)," +
  ".prev-next-area a, .notebook-line, .bd-footer-content p";

// A reader reaches whatever lies in a box that scrolls, as long as the box itself is on the page;
// what a box cuts off, or what leaves the page, is lost.
function lostToTheRight() {
  const { scrollWidth, clientWidth } = document.documentElement;
  const wide = [...document.querySelectorAll(THAT_MAY_BE_WIDE)].filter((e) => e.checkVisibility());
  const lost = wide.filter((element) => isLost(element, clientWidth));
  const page = scrollWidth > clientWidth ? [`a page ${scrollWidth} wide on ${clientWidth}`] : [];
  return [...page, ...lost.map((element) => `${element.tagName}: ${beginning(element)}`)];
}

/** @type {(element: Element, pageWidth: number) => boolean} */
function isLost(element, pageWidth) {
  /** @type {(box: Element) => string} */
  const overflow = (box) => getComputedStyle(box).overflowX;
  /** @type {(box: Element) => number} */
  const right = (box) => box.getBoundingClientRect().right;
  let box = element.parentElement;
  while (box && overflow(box) === "visible") box = box.parentElement;
  if (!box) return right(element) > pageWidth + 1;
  if (/auto|scroll/.test(overflow(box))) return right(box) > pageWidth + 1;
  return right(element) > right(box) + 1;
}

const THAT_SCROLLS =
  "mjx-container, .pst-scrollable-table-container, .text_html, .highlight pre, .wide-figure";

function wideBoxesWithoutHint() {
  return [...document.querySelectorAll(THAT_SCROLLS)]
    .filter((box) => box.checkVisibility() && box.scrollWidth > box.clientWidth + 1)
    .filter((box) => !box.matches(".wide.more-right") || box.getAttribute("tabindex") !== "0")
    .map(beginning);
}

// A stop that begins a line, or a bracket that ends one, beside a formula or a badge.
function tornPunctuation() {
  const held = [...document.querySelectorAll(".bd-article :is(span.math, .verdict)")];
  return held
    .filter((e) => e.checkVisibility())
    .flatMap((element) => {
      const boxes = [...element.getClientRects()];
      const [first, last] = [boxes[0], boxes[boxes.length - 1]];
      const before = besides(element.previousSibling, /[([]$/);
      const after = besides(element.nextSibling, /^[,.;:!?)\]°]/);
      const torn = [];
      if (before && before.bottom <= first.top + 2) torn.push(`before ${beginning(element)}`);
      if (after && after.top >= last.bottom - 2) torn.push(`after ${beginning(element)}`);
      return torn;
    });
}

// Where the mark stands with which a text ends, or begins, beside an element.
/** @type {(text: Node | null, pattern: RegExp) => DOMRect | null} */
function besides(text, pattern) {
  const mark = text instanceof Text ? text.data.match(pattern) : null;
  if (!text || mark?.index === undefined) return null;
  const range = document.createRange();
  range.setStart(text, mark.index);
  range.setEnd(text, mark.index + 1);
  return range.getBoundingClientRect();
}

// Formulas in a line of text that scroll in their own box.
function cutFormulas() {
  return [...document.querySelectorAll("span.math mjx-container.wide")].map(beginning);
}

// An id of the ledger, a number and its unit, and a link that is a name and a number: on one line.
const ON_ONE_LINE =
  /(?<![\w.])(?:[A-Z]{1,2}-\d[\d.]*(?<!\.)|(?:Table|Figure|Theorem) N?\d+|\d[\d.]* (?:cm|rad)²?)(?!\w)/g;

function brokenNames() {
  return [...document.querySelectorAll(".bd-article :is(p, li, td, figcaption)")]
    .filter((block) => block.checkVisibility() && !block.closest("live-figure"))
    .flatMap((block) => [...textsOf(block)])
    .filter(({ text }) => !text.parentElement?.closest("pre"))
    .flatMap(({ text }) =>
      [...text.data.matchAll(ON_ONE_LINE)].map((name) => {
        const range = document.createRange();
        range.setStart(text, name.index);
        range.setEnd(text, name.index + name[0].length);
        const lines = new Set([...range.getClientRects()].map(({ bottom }) => Math.round(bottom)));
        return lines.size > 1 ? name[0] : "";
      }),
    )
    .filter(Boolean);
}

// A picture of panels side by side is whole where there is room; on a phone the widest panel has the
// page, as a picture of one column has.
function smallPanels() {
  const page = document.querySelector(".bd-article")?.clientWidth ?? 0;
  return [...document.images]
    .filter((image) => image.matches(".wide-figure img, .panels img") && image.checkVisibility())
    .filter(({ parentElement, width }) => {
      const panels = [...(parentElement?.closest(".panels")?.querySelectorAll("img") ?? [])];
      if (panels.length) return Math.max(...panels.map((one) => one.width)) < 0.8 * page;
      return width < (parentElement?.closest(".one-column") ? 0.8 * page : 30 * 16);
    })
    .map((image) => image.alt.slice(0, 60));
}

function badImages() {
  return [...document.images]
    .filter((image) => !image.alt.trim() || !image.naturalWidth)
    .map((image) => `${image.getAttribute("src")} (alt: "${image.alt}")`);
}

// Contrast as WCAG 2 counts it: 4.5 to 1, for large text 3 to 1.
/** @type {(theme: string) => string[]} */
function faintText(theme) {
  document.documentElement.dataset.theme = theme;
  /** @type {Set<string>} */
  const faint = new Set();
  for (const { text, element } of textsOf(document.body)) {
    if (element.closest("script, style, mjx-assistive-mml, .headerlink, kbd")) continue;
    if (!element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
    const ratio = contrast(element);
    if (ratio < (isLarge(element) ? 3 : 4.5))
      faint.add(
        `${ratio.toFixed(1)} to 1: ${element.className} "${text.data.trim().slice(0, 40)}"`,
      );
  }
  return [...faint];
}

/** @type {(element: Element) => boolean} */
function isLarge(element) {
  const { fontSize, fontWeight } = getComputedStyle(element);
  return parseFloat(fontSize) >= (Number(fontWeight) >= 700 ? 18.66 : 24);
}

/** @type {(element: Element) => number} */
function contrast(element) {
  const ground = groundOf(element);
  const ink = over(rgba(getComputedStyle(element).color), ground);
  const [dark, light] = [luminance(ink), luminance(ground)].sort((a, b) => a - b);
  return (light + 0.05) / (dark + 0.05);
}

/** @type {(element: Element | null) => number[]} */
function groundOf(element) {
  if (!element) return [255, 255, 255];
  const own = rgba(getComputedStyle(element).backgroundColor);
  return own[3] === 1 ? own.slice(0, 3) : over(own, groundOf(element.parentElement));
}

// A canvas reads every notation of a colour; each is read once.
const pen = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
/** @type {Map<string, number[]>} */
const known = new Map();

/** @type {(colour: string) => number[]} */
function rgba(colour) {
  const read = known.get(colour) ?? readColour(colour);
  known.set(colour, read);
  return read;
}

/** @type {(colour: string) => number[]} */
function readColour(colour) {
  if (!pen) throw new Error("This browser has no canvas.");
  pen.clearRect(0, 0, 1, 1);
  pen.fillStyle = colour;
  pen.fillRect(0, 0, 1, 1);
  const [red, green, blue, alpha] = pen.getImageData(0, 0, 1, 1).data;
  return [red, green, blue, alpha / 255];
}

/** @type {(top: number[], ground: number[]) => number[]} */
function over(top, ground) {
  return [0, 1, 2].map((i) => top[i] * top[3] + ground[i] * (1 - top[3]));
}

/** @type {(rgb: number[]) => number} */
function luminance(rgb) {
  /** @type {(v: number) => number} */
  const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const [red, green, blue] = rgb.map((v) => linear(v / 255));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}
