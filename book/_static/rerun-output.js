"use strict";
// What a cell shows, made into nodes of the page. Text never becomes markup: tables, links and
// formulas are built node by node, pictures are images (whose scripts never run).

const rerunOutput = (() => {
  const MATH = /\$\$([^$]+)\$\$|\$([^$]+)\$/;
  const INLINE = [
    { find: /`([^`]+)`/, tag: "code" },
    { find: MATH, tag: "math" },
    { find: /\[([^\]]*)\]\(([^)\s]*)\)/, tag: "a" },
    { find: /\*\*([^*]+)\*\*/, tag: "strong" },
    { find: /\*([^*]+)\*/, tag: "em" },
    { find: /\{[\w:]+\}`([^`<]+?)(?:\s*<[^>]*>)?`/, tag: "span" },
  ];
  const ALLOWED = new Set(
    (
      "A ABBR B BR CODE DD DETAILS DIV DL DT EM FIGCAPTION FIGURE H2 H3 H4 H5 I LI OL P PRE SECTION SMALL " +
      "SPAN STRONG SUB SUMMARY SUP TABLE TBODY TD TH THEAD TR UL"
    ).split(" "),
  );
  const ATTRIBUTES = ["class", "colspan", "rowspan", "title", "lang"];

  /**
   * @param {string} tag @param {(Node | string)[]} children @param {string} name of its class
   * @returns {HTMLElement}
   */
  function make(tag, children = [], name = "") {
    const node = document.createElement(tag);
    if (name) node.className = name;
    node.append(...children);
    return node;
  }

  /** A formula, for MathJax. @param {string} text @param {boolean} display */
  function formula(text, display) {
    const inside = display ? `\\[${text}\\]` : `\\(${text}\\)`;
    return make(display ? "div" : "span", [inside], "math notranslate nohighlight");
  }

  /** An address that stays in the book, or none. @param {string} address */
  function safeAddress(address) {
    const plain = address.trim();
    if (/^[a-z][a-z0-9+.-]*:/i.test(plain) || plain.startsWith("//") || plain.startsWith("\\"))
      return "";
    const anchor = plain.startsWith("#") ? plain.replace(/[:.]/g, "-") : plain;
    if (anchor.startsWith("#") && !document.getElementById(anchor.slice(1))) return "";
    return anchor.replace(/\.(ipynb|md)(?=#|$)/, ".html");
  }

  /** @param {string} text @returns {(Node | string)[]} */
  function inline(text) {
    let first = null;
    for (const { find, tag } of INLINE) {
      const match = find.exec(text);
      if (
        match &&
        (!first ||
          match.index < first.match.index ||
          (match.index === first.match.index && match[0].length > first.match[0].length))
      )
        first = { match, tag };
    }
    if (!first) return text ? [text] : [];
    const { match, tag } = first;
    const rest = inline(text.slice(match.index + match[0].length));
    const before = match.index ? [text.slice(0, match.index)] : [];
    return [...before, inlineNode(tag, match), ...rest];
  }

  /** @param {string} tag @param {RegExpExecArray} match */
  function inlineNode(tag, match) {
    if (tag === "math") return formula((match[1] ?? match[2]).trim(), Boolean(match[1]));
    if (tag === "code") return make("code", [match[1]]);
    if (tag !== "a") return make(tag, inline(match[1]));
    const address = safeAddress(match[2]);
    const node = make(address ? "a" : "span", inline(match[1] || match[2]));
    if (address) node.setAttribute("href", address);
    return node;
  }

  /** The cells of a row of a table. @param {string} line */
  const cellsOf = (line) =>
    line
      .trim()
      .replace(/^\||\|$/g, "")
      .split(/(?<!\\)\|/)
      .map((cell) => cell.trim().replaceAll("\\|", "|"));

  /** @param {string[]} lines */
  function table(lines) {
    const [head, , ...body] = lines.map(cellsOf);
    const row = (/** @type {string[]} */ cells, /** @type {string} */ tag) =>
      make(
        "tr",
        cells.map((cell) => make(tag, [make("p", inline(cell))])),
      );
    const parts = [
      make(
        "tbody",
        body.map((cells) => row(cells, "td")),
      ),
    ];
    if (head.some(Boolean)) parts.unshift(make("thead", [row(head, "th")]));
    return make("div", [make("table", parts, "table")], "pst-scrollable-table-container");
  }

  /** Paragraphs, lists and tables. @param {string} text */
  function markdown(text) {
    const blocks = text
      .split(/\n\s*\n/)
      .map((block) => block.trim())
      .filter(Boolean);
    return make(
      "div",
      blocks.map((block) => {
        const lines = block.split("\n");
        if (lines.length > 1 && /^\s*\|?[\s:|-]+\|?\s*$/.test(lines[1]) && lines[1].includes("-"))
          return table(lines);
        if (lines.every((line) => /^\s*[-*] /.test(line))) {
          return make(
            "ul",
            lines.map((line) => make("li", inline(line.replace(/^\s*[-*] /, "")))),
          );
        }
        return make("p", inline(block));
      }),
      "output text_markdown",
    );
  }

  /** Markup of a cell, without what could run, load or leave the book. @param {string} text */
  function markup(text) {
    const parsed = new DOMParser().parseFromString(text, "text/html");
    /** @type {(node: Node) => (Node | string)[]} */
    const copy = (node) => {
      if (node.nodeType === Node.TEXT_NODE) return [node.textContent ?? ""];
      if (!(node instanceof Element)) return [];
      const inner = [...node.childNodes].flatMap(copy);
      if (!ALLOWED.has(node.tagName))
        return ["SCRIPT", "STYLE", "TEMPLATE"].includes(node.tagName) ? [] : inner;
      const made = make(node.tagName.toLowerCase(), inner);
      for (const name of ATTRIBUTES)
        if (node.hasAttribute(name)) made.setAttribute(name, node.getAttribute(name) ?? "");
      const address = node.tagName === "A" ? safeAddress(node.getAttribute("href") ?? "") : "";
      if (address) made.setAttribute("href", address);
      return [made];
    };
    return make("div", [...parsed.body.childNodes].flatMap(copy), "output text_html");
  }

  /** A picture, as an image. @param {string} svg @param {string} words what it shows */
  function picture(svg, words) {
    const image = document.createElement("img");
    image.src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    image.alt = words;
    return make("div", [image], "output image_svg");
  }

  /** @param {string} text */
  const printed = (text) =>
    make("div", [make("div", [make("pre", [text])], "highlight")], "output stream notranslate");

  /**
   * One output of a cell.
   * @param {Record<string, string>} bundle @param {string} words what its picture shows
   */
  function one(bundle, words) {
    if ("stream" in bundle) return printed(bundle.stream);
    if ("image/svg+xml" in bundle) return picture(bundle["image/svg+xml"], words);
    if ("text/markdown" in bundle) return markdown(bundle["text/markdown"]);
    if ("text/latex" in bundle) {
      const text = bundle["text/latex"].trim();
      const whole = /^\$\$?([\s\S]*?)\$?\$$/.exec(text);
      return whole ? formula(whole[1], true) : markdown(text);
    }
    if ("text/html" in bundle) return markup(bundle["text/html"]);
    return printed(bundle["text/plain"] ?? "");
  }

  /**
   * What is told of an error.
   * @param {{what: string, where: string, trace: string}} error
   */
  function failure({ what, where, trace }) {
    const parts = [make("p", [make("strong", [what])], "rerun-what")];
    if (where) parts.push(make("p", [`In ${where}.`]));
    if (trace) {
      parts.push(make("details", [make("summary", ["How it came to this"]), make("pre", [trace])]));
    }
    const node = make("div", parts, "rerun-error");
    node.setAttribute("role", "alert");
    return node;
  }

  /** Have the formulas of a node drawn. @param {Element} node */
  async function drawFormulas(node) {
    const mathjax = window.MathJax;
    if (node.querySelector(".math")) await mathjax?.typesetPromise?.([node]).catch(() => undefined);
  }

  return { make, one, failure, drawFormulas };
})();
