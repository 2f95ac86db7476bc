// Formulas, tables and output wider than the page scroll in their own box. Mark such a box and the
// sides where more is to see, for the style sheet, and let the keyboard reach it.
const BOXES =
  "mjx-container, .pst-scrollable-table-container, .cell_output .text_html, .highlight pre, " +
  ".wide-figure";

/** @type {(box: Element) => void} */
function markWide(box) {
  const hidden = box.scrollWidth - box.clientWidth;
  box.classList.toggle("wide", hidden > 1);
  box.classList.toggle("more-left", hidden > 1 && box.scrollLeft > 1);
  box.classList.toggle("more-right", hidden > 1 && box.scrollLeft < hidden - 1);
  if (hidden > 1) box.setAttribute("tabindex", "0");
  else box.removeAttribute("tabindex");
}

// A box changes its size with the window, and when the cell that hides it is opened; what it holds
// does so with the size of the letters.
function watchBoxes() {
  const sizes = new ResizeObserver((changes) => {
    for (const box of new Set(changes.map(({ target }) => target.closest(BOXES))))
      if (box) markWide(box);
  });
  for (const box of document.querySelectorAll(BOXES)) {
    box.addEventListener("scroll", () => markWide(box));
    for (const part of [box, box.firstElementChild]) if (part) sizes.observe(part);
  }
}

// A formula that is a little too wide shrinks to the page, before its box has to scroll.
const SMALLEST = 0.72;

function letFormulasShrink() {
  for (const drawn of document.querySelectorAll("mjx-container > svg")) {
    const width = drawn.getAttribute("width") ?? "";
    if (drawn instanceof SVGElement && width.endsWith("ex"))
      drawn.style.minWidth = `${parseFloat(width) * SMALLEST}ex`;
  }
}

// A browser may break the line on either side of a formula: keep its brackets and stops beside it.
function holdPunctuation() {
  for (const formula of document.querySelectorAll("span.math")) {
    const before = cutOff(formula.previousSibling, /[([“]+$/);
    const after = cutOff(formula.nextSibling, /^[,.;:!?)\]”’°%]+/);
    if (!before && !after) continue;
    const line = document.createElement("span");
    line.className = "unbroken";
    formula.replaceWith(line);
    line.append(before, formula, after);
  }
}

// A line may end in a name's hyphen and before its number: E-34, Table 6, chapter 11, 2.5 cm².
const WHOLE =
  /(?<![\w.])(?:[A-Z]{1,2}-\d[\d.]*\d|[A-Z]{1,2}-\d|(?:[Cc]hapter|Tables?|Figures?|Theorem) N?\d+|\d[\d.]* (?:cm²?|mm²?|m²?|rad²?|deg²|%))(?!\w)/g;
const PROSE = ".bd-article :is(p, li, dd, td, figcaption)";
const WHOLE_ALREADY = ".unbroken, .math, pre, live-figure";

function holdNames() {
  for (const block of document.querySelectorAll(PROSE)) {
    const walk = document.createTreeWalker(block, NodeFilter.SHOW_TEXT);
    const texts = [];
    while (walk.nextNode()) texts.push(walk.currentNode);
    for (const text of texts) {
      if (!(text instanceof Text) || text.parentElement?.closest(WHOLE_ALREADY)) continue;
      const parts = text.data.split(WHOLE);
      const names = text.data.match(WHOLE);
      if (!names) continue;
      text.replaceWith(...parts.flatMap((part, i) => [part, ...unbroken(names[i])]));
    }
  }
}

/** @type {(name: string | undefined) => HTMLElement[]} */
function unbroken(name) {
  if (name === undefined) return [];
  const line = document.createElement("span");
  line.className = "unbroken";
  line.textContent = name;
  return [line];
}

/** @type {(text: Node | null, pattern: RegExp) => string} */
function cutOff(text, pattern) {
  if (!(text instanceof Text)) return "";
  const found = text.data.match(pattern)?.[0] ?? "";
  if (found) text.data = text.data.replace(pattern, "");
  return found;
}

// The theme unfolds the part of the open chapter and scrolls to it; where that is in sight, keep the
// top. On the front page the first part is unfolded.
function showTopOfSidebar() {
  const sidebar = document.querySelector(".bd-sidebar-primary");
  const chapter = sidebar?.querySelector(".current.active");
  if (!sidebar) return;
  if (!chapter) sidebar.querySelector("details")?.setAttribute("open", "");
  const bottom = chapter ? chapter.getBoundingClientRect().bottom + sidebar.scrollTop : 0;
  if (bottom < window.innerHeight) sidebar.scrollTop = 0;
}

// On paper the page is light, whatever the screen shows.
const root = document.documentElement;
/** @type {string | undefined} */
let themeOnScreen;
window.addEventListener("beforeprint", () => {
  themeOnScreen = root.dataset.theme;
  root.dataset.theme = "light";
});
window.addEventListener("afterprint", () => {
  root.dataset.theme = themeOnScreen ?? "light";
});

// A desk in a frame tells its height; it is told whether the page is light or dark.
const desks = document.getElementsByTagName("iframe");
function tellTheme() {
  const theme = root.dataset.theme === "dark" ? "dark" : "light";
  for (const frame of desks) frame.contentWindow?.postMessage({ theme }, "*");
}
window.addEventListener("message", ({ data, source }) => {
  const frame = [...desks].find((one) => one.contentWindow === source);
  if (!frame || !Number.isFinite(data?.explorerHeight)) return;
  frame.height = String(Math.ceil(data.explorerHeight));
  tellTheme();
});
new MutationObserver(tellTheme).observe(root, { attributeFilter: ["data-theme"] });

// What the theme and docutils leave without a name, or with a role that assistive software refuses.
function repairNames() {
  for (const summary of document.querySelectorAll(".bd-sidebar-primary details > summary")) {
    const chapter = summary.closest("li")?.querySelector("a")?.textContent.trim();
    summary.setAttribute("aria-label", `Pages of ${chapter}`);
  }
  const home = document.querySelector(".bd-sidebar-primary .sidebar-primary-item:has(.logo)");
  home?.setAttribute("role", "region");
  home?.setAttribute("aria-label", "The book");
  for (const odd of document.querySelectorAll(".citation-list, [role=doc-biblioentry]"))
    odd.removeAttribute("role");
  for (const head of document.querySelectorAll("th")) {
    if (head.textContent.trim() || head.querySelector("img, svg, math")) continue;
    const corner = document.createElement("td"); // an empty corner heads nothing
    corner.className = head.className;
    head.replaceWith(corner);
  }
}

// A module's name is long for a phone and for a side bar: it may break after a dot or a low line.
const NAMES =
  ".prev-next-title, .bd-article :is(h1, cite), .bd-sidebar-primary nav a, " +
  "#traceability td:last-child .pre, .results-table :is(th a, summary)";

function breakNames() {
  for (const name of document.querySelectorAll(NAMES)) {
    for (const text of [...name.childNodes].filter((node) => node instanceof Text)) {
      const parts = text.data.split(/(?<=[._])(?=\w)/);
      text.replaceWith(...parts.flatMap((part) => [part, document.createElement("wbr")]));
    }
  }
}

window.addEventListener("load", () => {
  repairNames();
  breakNames();
  holdNames();
  showTopOfSidebar();
  const formulasShown = window.MathJax?.startup?.promise ?? Promise.resolve();
  formulasShown.then(letFormulasShrink).then(holdPunctuation).then(watchBoxes);
});
