"use strict";
// Run a chapter in its own page: a button, editable cells, outputs in their places, and a comparison
// of the numbers with the printed ones. Python starts only by a click.

(() => {
  const { Desk, known, bytesOf, megabytes } = rerunEngine;
  const { make, one, failure, drawFormulas } = rerunOutput;

  /** By the name that a cell may import: the part of the files that brings it. */
  const PARTS_OF = /** @type {Record<string, string>} */ ({
    contourpy: "matplotlib",
    lxml: "lxml",
    matplotlib: "matplotlib",
    mpmath: "sympy",
    scipy: "scipy",
    sympy: "sympy",
    tomlkit: "tomlkit",
    trimesh: "trimesh",
  });

  /**
   * A code cell of the chapter; `index` is its number in the notebook.
   * @typedef {{index: number, source: string}} Cell
   * @typedef {{recorded: number, cells: Cell[]}} Chapter
   */

  const root = document.documentElement.dataset.content_root ?? "./";
  const page =
    location.pathname
      .split("/")
      .pop()
      ?.replace(/\.html$/, "") ?? "";
  const files = known();
  const entry = files?.files.find((file) => file.name === page);
  const title = document.querySelector(".bd-article h1");
  if (!title || !files || !entry) return;
  const needed = ["engine", "base", "library", ...(entry.needs ?? [])];

  /** @param {string} text @param {() => void} action @param {string} name */
  function button(text, action, name = "") {
    const node = /** @type {HTMLButtonElement} */ (make("button", [text], `rerun-button ${name}`));
    node.type = "button";
    node.addEventListener("click", action);
    return node;
  }

  const exercises = document.querySelector(".exercises-where");
  exercises?.append(
    " They run in this page too: run it, edit a cell, put your value in place of the dots, and run the cell.",
  );

  // --- the bar at the top -----------------------------------------------------------------------

  const start = button("Run this page", () => void runAll(), "rerun-start");
  const stop = button("Stop", () => desk.end(), "rerun-stop");
  const reset = button("Reset the page", resetAll, "rerun-reset");
  const progress = document.createElement("progress");
  progress.setAttribute("aria-label", "Progress");
  const said = make("p", [], "rerun-said");
  said.setAttribute("role", "status");
  const details = make("ul", [], "rerun-differences");
  const bar = make(
    "div",
    [make("div", [start, stop, reset, progress], "rerun-row"), said, details],
    "rerun-bar",
  );
  title.after(bar);

  let chapter = /** @type {Chapter | null} */ (null);
  let results = /** @type {Map<string, any>} */ (new Map());
  let lost = /** @type {string} */ (""); // a library that a cell lacked

  /** @param {string} text @param {"" | "busy" | "good" | "bad"} state */
  function say(text, state = "") {
    said.textContent = text;
    bar.dataset.state = state;
    stop.hidden = state !== "busy";
    progress.hidden = state !== "busy";
    start.disabled = state === "busy";
    reset.hidden = state === "busy" || !chapter;
    for (const cell of cells.values()) cell.idle(state !== "busy");
  }

  const opening = `import kernel
cells = kernel.Cells(${JSON.stringify(page.slice(page.indexOf("_") + 1))})
cells.watch()
cells`;
  const desk = new Desk(root, needed, ["kernel.py"], opening, progress, (text, isBusy) =>
    say(text, isBusy ? "busy" : ""),
  );

  // --- cells ------------------------------------------------------------------------------------

  /** A cell of the page: its code, an editor once the code is changed, and its output. */
  class Place {
    /** @param {Cell} cell */
    constructor({ index, source }) {
      this.index = index;
      this.printed = source;
      this.code = /** @type {HTMLElement | null} */ (
        document.querySelector(`.rerun-code-${index}`)
      );
      this.output = /** @type {HTMLElement | null} */ (
        document.querySelector(`.rerun-output-${index}`)
      );
      this.made = /** @type {HTMLElement | null} */ (null);
      this.editor = /** @type {HTMLTextAreaElement | null} */ (null);
      this.buttons = /** @type {HTMLButtonElement[]} */ ([]);
      this.mark = make("span", [], "rerun-mark");
      if (this.code) this.tools(this.code);
    }

    get source() {
      return this.editor?.value ?? this.printed;
    }

    /** @param {HTMLElement} code */
    tools(code) {
      const edit = button("Edit", () => this.edit());
      const onward = button("Run from here", () => void runFrom(this.index));
      const alone = button("Run this cell", () => void runFrom(this.index, true));
      const back = button("Reset", () => this.reset());
      back.hidden = true;
      this.buttons = [edit, onward, alone, back];
      this.row = make("div", [edit, alone, onward, back, this.mark], "rerun-tools");
      code.after(this.row);
    }

    /** @param {boolean} idle */
    idle(idle) {
      for (const each of this.buttons) each.disabled = !idle;
      if (this.editor) this.editor.readOnly = !idle;
    }

    edit() {
      if (!this.code || this.editor) return this.editor?.focus();
      this.editor = document.createElement("textarea");
      Object.assign(this.editor, {
        className: "rerun-editor",
        value: this.printed,
        spellcheck: false,
      });
      this.editor.setAttribute("aria-label", `Code of cell ${this.index + 1}`);
      this.editor.setAttribute("autocapitalize", "off");
      this.editor.addEventListener("input", () => this.changed());
      this.editor.addEventListener("keydown", (event) => this.key(event));
      this.code.hidden = true;
      this.code.after(this.editor);
      this.fit();
      this.editor.focus();
      this.buttons[3].hidden = false;
    }

    /** @param {KeyboardEvent} event */
    key(event) {
      if (event.key === "Enter" && (event.shiftKey || event.ctrlKey)) {
        event.preventDefault();
        void runFrom(this.index, event.ctrlKey);
      }
    }

    fit() {
      if (!this.editor) return;
      this.editor.rows = Math.min(40, this.editor.value.split("\n").length + 1);
    }

    changed() {
      this.fit();
      const isChanged = this.source !== this.printed;
      this.mark.textContent = isChanged ? "changed" : "";
      this.row?.classList.toggle("rerun-changed", isChanged);
    }

    reset() {
      this.editor?.remove();
      this.editor = null;
      if (this.code) this.code.hidden = false;
      this.buttons[3].hidden = true;
      this.changed();
      this.clear();
    }

    /** Show the printed output again. */
    clear() {
      for (const image of this.made?.querySelectorAll("img") ?? []) URL.revokeObjectURL(image.src);
      this.made?.remove();
      this.made = null;
      this.output?.classList.remove("rerun-replaced");
      this.output?.removeAttribute("inert");
    }

    /** Put nodes in the place of the printed output. @param {Node[]} nodes @param {boolean} keep the printed output too */
    show(nodes, keep = false) {
      this.clear();
      if (!nodes.length && !this.output) return;
      const caption = this.output?.querySelector("figcaption")?.cloneNode(true);
      if (caption instanceof Element && !keep) {
        for (const each of caption.querySelectorAll("[id], .headerlink")) each.remove();
        nodes = [...nodes, caption];
      }
      this.made = make("div", nodes, "cell_output docutils container rerun-output");
      this.made.dataset.cell = String(this.index);
      const before = this.output ?? this.row ?? this.code;
      if (!before) return;
      before.after(this.made);
      if (!keep) this.output?.classList.add("rerun-replaced");
      if (!keep) this.output?.setAttribute("inert", "");
      void drawFormulas(this.made);
    }
  }

  const cells = /** @type {Map<number, Place>} */ (new Map());

  // --- running ----------------------------------------------------------------------------------

  /** Read the cells, once: their buttons come with them. */
  async function open() {
    if (chapter) return;
    chapter = /** @type {Chapter} */ (JSON.parse(await desk.text(page)));
    for (const cell of chapter.cells) cells.set(cell.index, new Place(cell));
  }

  async function runAll() {
    desk.end();
    await desk.guarded(async () => {
      say("Starting …", "busy");
      await open();
      results = new Map();
      lost = "";
      await run([...cells.values()]);
    });
  }

  /** @param {number} index @param {boolean} alone */
  async function runFrom(index, alone = false) {
    await desk.guarded(async () => {
      const isNew = !desk.engine;
      const chosen = [...cells.values()].filter((cell) => {
        if (alone) return cell.index === index || (isNew && cell.index < index);
        return isNew || cell.index >= index;
      });
      await run(chosen);
    });
  }

  /** @param {Place[]} chosen */
  async function run(chosen) {
    const python = await desk.ready();
    let failed = /** @type {Place | null} */ (null);
    for (const [k, cell] of chosen.entries()) {
      Object.assign(progress, { max: chosen.length, value: k });
      say(`Running cell ${k + 1} of ${chosen.length} …`, "busy");
      const answer = await runCell(python, cell);
      if (answer.error && !answer.kept) {
        failed = cell;
        break;
      }
    }
    conclude(failed);
  }

  /** @param {NonNullable<typeof desk.engine>} python @param {Place} cell */
  async function runCell(python, cell) {
    let answer = await python.call("run", cell.index, cell.source);
    const part = PARTS_OF[answer.error?.missing];
    if (part && (await python.load([part], (done, whole) => desk.reading(done, whole)))) {
      answer = await python.call("run", cell.index, cell.source);
    }
    for (const each of answer.compared) results.set(each.id, each);
    const absent = answer.error?.absent;
    lost ||= absent ?? "";
    if (absent || (lost && answer.error?.what.startsWith("NameError"))) {
      const why = absent
        ? `This cell needs ${absent}, which cannot be had inside a page. Its output is the printed one.`
        : `This cell needs what a cell above could not compute without ${lost}. Its output is the printed one.`;
      cell.show([make("p", [why], "rerun-note")], true);
      return { ...answer, kept: true };
    }
    const words = [...(cell.output?.querySelectorAll("img") ?? [])].map((image) => image.alt);
    let pictures = 0;
    const nodes = answer.outputs.map((/** @type {Record<string, string>} */ bundle) =>
      one(bundle, words["image/svg+xml" in bundle ? pictures++ : 0] ?? "A picture of this cell"),
    );
    if (answer.error) nodes.push(failure(answer.error));
    cell.show(nodes);
    return answer;
  }

  /** @param {Place | null} failed */
  function conclude(failed) {
    const compared = [...results.values()];
    const agree = compared.filter((each) => each.agrees).length;
    const whole = Math.max(chapter?.recorded ?? 0, compared.length);
    const changed = [...cells.values()].some((cell) => cell.source !== cell.printed);
    details.replaceChildren();
    if (failed) {
      say("A cell raised an error: what follows it did not run.", "bad");
      failed.made?.scrollIntoView({ block: "center" });
      return;
    }
    const numbers = whole
      ? `${agree} of ${whole} numbers agree with the printed ones, within their stated errors.`
      : "All cells have run.";
    const notes = [
      changed ? "You have changed a cell, so other numbers are to be expected." : "",
      lost ? `Cells that need ${lost} keep their printed output.` : "",
    ].filter(Boolean);
    say([numbers, ...notes].join(" "), agree === whole ? "good" : changed || lost ? "" : "bad");
    for (const { id, now, then } of compared.filter((each) => !each.agrees)) {
      details.append(
        make("li", [
          make("code", [id]),
          `: ${JSON.stringify(now)}, printed ${JSON.stringify(then)}`,
        ]),
      );
    }
  }

  function resetAll() {
    desk.end();
    details.replaceChildren();
    for (const cell of cells.values()) {
      if (cell.code) cell.reset();
      else cell.clear();
    }
    say(invitation());
  }

  const invitation = () => {
    const whole = bytesOf(needed);
    const way = location.protocol === "file:" ? "It reads" : "It downloads";
    return `Python runs inside this page, and its code becomes editable. ${way} about ${megabytes(whole)} once, and it takes up to half a gigabyte of memory.`;
  };
  say(invitation());
})();
