"use strict";
/* Draws the figures of a page where its hooks stand: <div class="play" data-figure="KIND" ...>.
   It comes last; the engine, the data and the kinds that the page needs stand before it. */

{
  /** A small explorer: two pictures and a line that says what is true. Options: data-controls,
      data-show (names of layers), data-q (degrees or lengths), data-scale, data-lit (a boundary).
   * @type {FigureKind} */
  const explorer = (element, options, { robot }) => {
    if (!robot) throw new Error("An explorer needs a robot.");
    const layers = options.show?.split(/[ ,]+/);
    const kinds = robot.joints.map((joint) => joint.kind);
    qboundEngine.mount(element, robot, {
      controls: (options.controls ?? "legend").split(/[ ,]+/),
      ...(options.q && { q: poseOf(options.q, kinds) }),
      ...(options.scale && { scale: Number(options.scale) }),
      ...(layers && { show: shown(layers) }),
      ...(options.lit && { lit: options.lit }),
    });
  };

  /** @type {(text: string, kinds: Kind[]) => Pose} */
  function poseOf(text, kinds) {
    const values = text.replaceAll("−", "-").split(/[ ,]+/).map(Number);
    return values.map((value, j) => (kinds[j] === "revolute" ? (value * Math.PI) / 180 : value));
  }

  /** @type {(layers: string[]) => State["show"]} */
  function shown(layers) {
    const [workspace, polygon, sample, names] = ["workspace", "polygon", "sample", "names"].map(
      (name) => layers.includes(name),
    );
    return { workspace, polygon, sample, names };
  }

  /** Draw the figure of one hook. Where that fails, the page stays as it is without scripts.
   * @type {(hook: HTMLElement) => void} */
  function play(hook) {
    const { figure = "", replaces, robot = "minervabot-v2", rule = "clearance" } = hook.dataset;
    const kind = { explorer, ...window.qboundFigures }[figure];
    const key = robot + (rule === "clearance" ? "" : `-${rule}`);
    const fixed = replaces ? document.getElementById(replaces) : null;
    const picture = fixed?.querySelector("img, svg, object") ?? null;
    hook.classList.add("qbound");
    if (picture) picture.before(hook);
    try {
      if (!kind) throw new Error(`There is no figure kind "${figure}".`);
      if (replaces && !picture) throw new Error(`There is no picture in a figure "${replaces}".`);
      kind(hook, hook.dataset, {
        robot: window.qboundRobots?.[key] ?? null,
        own: window.qboundData?.[`${figure}-${key}`],
      });
      if (picture) hook.classList.add("replaces");
      picture?.classList.add("played");
    } catch (error) {
      console.error(error);
      hook.remove();
    }
  }

  for (const hook of document.querySelectorAll("div.play"))
    if (hook instanceof HTMLElement) play(hook);

  // A word that names a curve, <span class="lights b7"> or with data-light, lights it in the figures
  // of its page. Under a finger the light stays until the finger comes down elsewhere.
  /** @type {(detail: string | null) => void} */
  const light = (detail) => {
    for (const figure of document.querySelectorAll("div.play"))
      figure.dispatchEvent(new CustomEvent("qbound-light", { detail }));
  };
  const words = document.querySelectorAll(".lights");
  for (const word of words) {
    const own = [...word.classList].find((one) => /^b\d$/.test(one))?.toUpperCase();
    const name = word.getAttribute("data-light") ?? own ?? null;
    word.addEventListener("pointerenter", () => light(name));
    word.addEventListener("pointerleave", (event) => {
      if (event instanceof PointerEvent && event.pointerType !== "touch") light(null);
    });
  }
  if (words.length > 0)
    document.addEventListener("pointerdown", ({ target }) => {
      if (!(target instanceof Element && target.closest(".lights"))) light(null);
    });
}
