// A card for what a link names: shown while a pointer or the keyboard's focus is on the link. A
// finger's first tap shows it, and a link in the card leads on. The cards come with cards.js, which
// is loaded when the first is asked for; a page opened from the file system may load no more.

const BOOK = new URL(document.documentElement.dataset.content_root ?? "./", location.href);
const LINKS = ".bd-article a[href*='#']:not(.headerlink)";
const BEFORE_SHOWN = 180; // ms: a pointer that passes over a link asks nothing
const BEFORE_GONE = 300; // ms: time to move into the card

const card = document.createElement("div");
card.className = "hover-card";
card.id = "hover-card";
card.hidden = true;

/** @type {HTMLAnchorElement | null} */
let shownFor = null;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let waiting;
let pointer = { kind: "mouse", x: 0 };

/** @type {(link: HTMLAnchorElement) => string} */
function addressOf(link) {
  const { origin, pathname, hash } = new URL(link.href, location.href);
  if (origin !== BOOK.origin || !pathname.startsWith(BOOK.pathname)) return "";
  return decodeURIComponent(pathname.slice(BOOK.pathname.length) || "index.html") + hash;
}

/** @type {(target: EventTarget | null) => HTMLAnchorElement | null} */
function linkAt(target) {
  const link = target instanceof Element ? target.closest(LINKS) : null;
  return link instanceof HTMLAnchorElement && !card.contains(link) ? link : null;
}

/** @type {(name: string) => Promise<void>} */
function load(name) {
  return new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = new URL(`_static/${name}`, BOOK).href;
    script.addEventListener("load", () => done());
    script.addEventListener("error", failed);
    document.head.append(script);
  });
}

/** @type {Promise<Record<string, BookCard>> | undefined} */
let cards;

// All cards of the book by their addresses, "chapters/06_theorem_2.html#tab-6".
function allCards() {
  cards ??= load("cards.js").then(
    () => bookCards,
    () => ({}), // the book on one page has none
  );
  return cards;
}

/** @type {(found: BookCard) => void} */
function fill(found) {
  card.innerHTML = found.html;
  for (const image of card.querySelectorAll("img"))
    image.src = new URL(image.getAttribute("src") ?? "", BOOK).href;
}

// A page without formulas has not loaded what sets them.
/** @type {Promise<void> | undefined} */
let typesetter;

async function typeset() {
  if (!card.querySelector(".math")) return;
  if (!document.querySelector("script[src*='tex-svg-full']")) {
    window.MathJax ??= { startup: { typeset: false } };
    typesetter ??= load("tex-svg-full.js");
  }
  await typesetter;
  await window.MathJax?.startup?.promise;
  await window.MathJax?.typesetPromise?.([card]);
}

// Below the line of the link that the pointer is on, above it where there is more room.
/** @type {(link: HTMLAnchorElement) => void} */
function place(link) {
  const lines = [...link.getClientRects()];
  const line = lines.find((r) => r.left <= pointer.x && pointer.x <= r.right) ?? lines[0];
  const host = card.offsetParent?.getBoundingClientRect();
  if (!line || !host) return;
  const { offsetWidth: width, offsetHeight: height } = card;
  const edge = document.documentElement.clientWidth - width - 8;
  const goesUp = height + 8 > window.innerHeight - line.bottom && line.top > height + 8;
  const top = goesUp ? line.top - height - 4 : line.bottom + 4;
  card.style.left = `${Math.max(8, Math.min(line.left, edge)) - host.left}px`;
  card.style.top = `${top - host.top}px`;
}

/** @type {(link: HTMLAnchorElement, tapped?: boolean) => Promise<void>} */
async function show(link, tapped = false) {
  shownFor?.removeAttribute("aria-describedby");
  shownFor = link;
  const found = (await allCards())[addressOf(link)];
  if (shownFor !== link) return;
  if (!found) {
    if (tapped) link.click();
    hide();
    return;
  }
  fill(found);
  if (tapped) {
    const go = document.createElement("a");
    go.className = "card-go";
    go.href = link.href;
    go.textContent = `Go to ${found.name}`;
    card.append(go);
    card.removeAttribute("role");
  } else {
    card.setAttribute("role", "tooltip");
    link.setAttribute("aria-describedby", card.id);
  }
  card.hidden = false;
  place(link);
  await typeset();
  if (shownFor === link) place(link);
}

function hide() {
  stay();
  shownFor?.removeAttribute("aria-describedby");
  shownFor = null;
  card.hidden = true;
}

function stay() {
  clearTimeout(waiting);
  waiting = undefined;
}

/** @type {(what: () => void, after: number) => void} */
function soon(what, after) {
  stay();
  waiting = setTimeout(what, after);
}

document.addEventListener("pointerover", (event) => {
  if (event.pointerType === "touch") return;
  const link = linkAt(event.target);
  if (event.target instanceof Element && card.contains(event.target)) stay();
  else if (link && link === shownFor) stay();
  else if (link) {
    pointer = { kind: event.pointerType, x: event.clientX };
    soon(() => show(link), BEFORE_SHOWN);
  } else if (shownFor && !shownFor.matches(":focus-visible")) soon(hide, BEFORE_GONE);
  else if (!shownFor) stay();
});

document.addEventListener("focusin", ({ target }) => {
  const link = linkAt(target);
  if (link?.matches(":focus-visible")) show(link);
});

document.addEventListener("focusout", ({ relatedTarget }) => {
  if (shownFor && !(relatedTarget instanceof Node && card.contains(relatedTarget)))
    if (pointer.kind !== "touch") hide();
});

document.addEventListener("pointerdown", (event) => {
  pointer = { kind: event.pointerType, x: event.clientX };
});

document.addEventListener(
  "click",
  (event) => {
    const link = linkAt(event.target);
    if (event.target instanceof Node && card.contains(event.target)) return;
    if (link && link !== shownFor && pointer.kind === "touch" && event.isTrusted) {
      event.preventDefault();
      show(link, true);
    } else hide();
  },
  { capture: true },
);

document.addEventListener("keydown", ({ key }) => {
  if (key === "Escape") hide();
});

document.querySelector("main")?.append(card);
