// On the search page: whoever asks for "Table 6", "eq. 29", "E-34" or "aspect" is led there first;
// whoever asks for other words is led to chapters first, and to pages of the API last.

/** @type {[RegExp, string][]} */
const SHORT_FORMS = [
  [/^\((\w+)\)$/, "equation $1"],
  [/\beq(n|s|uations?)?\b/, "equation"],
  [/\bfig(s|ures?)?\b/, "figure"],
  [/\btab(s|les?)?\b/, "table"],
  [/\bth(m|eorems?)\b/, "theorem"],
  [/\bref(s|erences?)?\b/, "reference"],
  [/^(the )?(entry|claim|verdict) (?=\S)/, ""],
  [/[^a-z0-9.']+/g, " "], // "e-34" and "e 34" are one name
  [/\. | $|\.$/g, " "],
  [/(?<=[a-z])(?=\d)/g, " "], // so are "e34" and "n5"
];

/** @type {(name: string) => string} */
function plain(name) {
  const lower = name.toLowerCase().replaceAll("’", "'").trim();
  return SHORT_FORMS.reduce((text, [form, full]) => text.replace(form, full), lower).trim();
}

// A word of the glossary may have two forms, "Prismatic joint, revolute joint", and a plural.
/** @type {(card: BookCard, wanted: string) => boolean} */
function bears(card, wanted) {
  const names = card.name.split(", ").map(plain);
  const numbered = /^[a-z]+ \d/.test(wanted) ? ` ${wanted}` : null; // "n 5" is that of every kind
  return names.some(
    (name) => name === wanted || `${name}s` === wanted || (numbered && name.endsWith(numbered)),
  );
}

/** @type {(address: string, card: BookCard) => SearchResult} */
function resultOf(address, card) {
  const [file, anchor] = address.split("#");
  const page = file.replace(/\.html$/, "");
  return [page, `${card.name} (${card.page})`, `#${anchor}`, null, 1000, file, "title"];
}

/** Where a page stands among what is found: the greater, the earlier.
 * @type {(found: SearchResult) => number} */
function rank([page]) {
  if (page.startsWith("chapters/")) return 2;
  return page.startsWith("generated/") || page === "api" ? 0 : 1;
}

/** How often a page has the words, where the texts are at hand.
 * @type {(words: string) => (page: string) => number} */
function counter(words) {
  const texts = typeof bookTexts === "undefined" ? {} : bookTexts;
  const word = RegExp(words.trim().replace(/\W+/g, "|"), "gi");
  return (page) => texts[`${page}.html`]?.match(word)?.length ?? 0;
}

// An excerpt is taken from the page that was found. A page opened from the file system may not fetch
// another one: it reads the texts of all pages from a script.
if (location.protocol === "file:") {
  const read = load("texts.js");
  window.fetch = async (address) => {
    await read;
    const page = decodeURIComponent(new URL(`${address}`, location.href).pathname);
    return new Response(bookTexts[page.slice(BOOK.pathname.length)]);
  };
}

// An excerpt is plain text, so the signs of its formulas are letters.
const SIGNS = [
  "alpha α, beta β, gamma γ, delta δ, theta θ, mu μ, pi π, psi ψ, rho ρ, sigma σ, varphi φ, phi φ",
  "nabla ∇, Sigma Σ, sum Σ, int ∫, oint ∮, infty ∞, dots …, cdot ·, circ °, times ×, pm ±",
  "mp ∓, le ≤, leq ≤, ge ≥, geq ≥, ne ≠, approx ≈, in ∈, prec ≺, to →, mapsto ↦, top ᵀ, forall ∀",
];
/** @type {Record<string, string>} */
const SIGN_OF = Object.fromEntries(
  SIGNS.flatMap((row) => row.split(", ").map((s) => s.split(" "))),
);

/** @type {[RegExp, string][]} */
const LAYOUT = [
  [/\\(begin|end)\{\w+\*?\}/g, ""],
  [
    /\\([bB]igg?[lr]?|left|right|displaystyle|mathrm|mathbf|mathsf|operatorname|text)(?![a-z])/g,
    "",
  ],
  [/\\tfrac12/g, "½"],
  [/_\{([^{}]*)\}/g, "$1"],
  [/\\sqrt\{([^{}]*)\}/g, "√($1)"],
  [/\\[dt]?frac\{([^{}]*)\}\{([^{}]*)\}/g, "$1/$2"],
  [/\\\|/g, "‖"],
  [/\\[,;:! ]|\\\\|\\quad|[&~]/g, " "],
  [/\^\{?-1\}?/g, "⁻¹"],
  [/\^\{?\s*T\}?/g, "ᵀ"],
  [/\^2/g, "²"],
  [/\^(?=\{?\\(circ|top))|_|(?<!\\)[{}]/g, ""],
  [/\\([{}])/g, "$1"],
];

/** @type {(command: string) => string} */
function nameOfSign(command) {
  const name = command.slice(1);
  return SIGN_OF[name] ?? ` ${name}`;
}

/** @type {(text: string) => string} */
function withoutTex(text) {
  return text.replace(/\\\((.*?)\\\)|\\\[(.*?)\\\]/gs, (_, inline, display) => {
    let tex = inline ?? display;
    for (const [form, sign] of LAYOUT) tex = tex.replace(form, sign);
    const named = tex.replace(/\\[a-zA-Z]+/g, nameOfSign);
    return named.replace(/\s+/g, " ").trim();
  });
}

// Words that were searched for are marked on the page of a result, and on no other page.
let leadsToResult = false;
document.addEventListener("click", ({ target }) => {
  leadsToResult = target instanceof Element && target.closest("#search-results a") !== null;
});
window.addEventListener("pagehide", () => {
  if (!leadsToResult) localStorage.removeItem("sphinx_highlight_terms");
});

{
  const { query, htmlToText, _performSearch: others } = Search;
  Search.htmlToText = (...page) => withoutTex(htmlToText(...page));
  /** @type {[string, BookCard][]} */
  let cards = [];
  Search.query = async (text) => {
    cards = Object.entries(await allCards());
    if (location.protocol === "file:") await load("texts.js");
    query(text);
  };
  // Sphinx shows its results from the last to the first.
  Search._performSearch = (text, ...terms) => {
    const named = cards.filter(([, card]) => bears(card, plain(text)));
    const first = named.map(([address, card]) => resultOf(address, card));
    const rest = others(text, ...terms);
    const isCode = /[._]/.test(text); // the name of a function or a module
    const uses = counter(text);
    if (!isCode) rest.sort((a, b) => rank(a) - rank(b) || a[4] - b[4] || uses(a[0]) - uses(b[0]));
    return [...rest, ...first.reverse()];
  };
}
