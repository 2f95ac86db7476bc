"use strict";
/* Every region: the arm is dragged through one, stops where a boundary begins, and the figure says
   which it is and what lies behind it. */
{
  const STEP = Math.PI / 720; // a quarter of a degree: no wall between two regions is thinner
  const HALVINGS = 12;
  const BEHIND = Math.PI / 36; // how far to look for what a boundary hides

  /* --- arithmetic: tests/book/test_play_arithmetic.py runs it beside the library -------------------- */

  /** What must not be negative: each boundary in use, restricted to the joints that move. One about
      bodies has no form.
   * @type {(robot: Robot) => Rule[]} */
  function rulesOf(robot) {
    const { isAboutBodies, restrict } = qboundEngine;
    return robot.boundaries
      .filter((wall) => wall.used)
      .map((wall) => ({
        wall,
        form: isAboutBodies(wall) ? null : restrict(wall.form, robot, robot.q),
      }));
  }

  /** The boundaries that a pair of joint values violates.
   * @type {(robot: Robot, rules: Rule[], pair: Pair) => Wall[]} */
  function violated(robot, rules, pair) {
    const { basis, bodiesMargin, evaluate, framesOf, isAboutBodies, placedParts } = qboundEngine;
    const { withPair } = qboundEngine;
    const [x, y] = pair.map((value, k) => basis(robot.joints[robot.free[k]].kind, value));
    const found = rules.some(({ form }) => form === null)
      ? framesOf(robot, withPair(robot, robot.q, pair))
      : [];
    const placed = found.length > 0 ? placedParts(robot, found) : [];
    return rules
      .filter(({ wall, form }) =>
        isAboutBodies(wall) || !form
          ? bodiesMargin(robot, /** @type {BodiesWall} */ (wall), found, placed) < 0
          : evaluate(form, x, y) < 0,
      )
      .map(({ wall }) => wall);
  }

  /** Go from a safe pose towards another in small steps; where one is barred, along the boundary by
      one joint alone; where that is barred too, stop. `by` is what barred the straight way last.
   * @type {(robot: Robot, rules: Rule[], from: Pair, to: Pair) => Slid} */
  function slide(robot, rules, from, to) {
    let [at, by] = [from, /** @type {Wall[]} */ ([])];
    const goal = qboundEngine.wayTo(robot, from, to).map((way, k) => from[k] + way);
    const most = Math.max(...goal.map((value, k) => Math.abs(value - from[k]))) / STEP;
    for (let i = 0; i < 2 * Math.ceil(most); i += 1) {
      const rest = goal.map((value, k) => value - at[k]);
      const size = Math.max(...rest.map(Math.abs));
      if (size === 0) break;
      const share = Math.min(1, STEP / size);
      const next = at.map((value, k) => value + share * rest[k]);
      const barred = violated(robot, rules, next);
      if (barred.length === 0) {
        at = next;
        continue;
      }
      by = barred;
      const single = [0, 1]
        .filter((k) => Math.abs(rest[k]) > 1e-9)
        .sort((a, b) => Math.abs(rest[b]) - Math.abs(rest[a]))
        .map((k) => at.map((value, j) => (j === k ? value + step(rest[k]) : value)))
        .find((pair) => violated(robot, rules, pair).length === 0);
      if (!single) return { at: upTo(robot, rules, at, next), by, goal };
      at = single;
    }
    const arrived = Math.max(...goal.map((value, k) => Math.abs(value - at[k]))) < 1e-9;
    return { at, by: arrived ? [] : by, goal };
  }

  /** @type {(rest: number) => number} */
  function step(rest) {
    return Math.sign(rest) * Math.min(STEP, Math.abs(rest));
  }

  /** The last safe pose on the way from a safe one to one that is not, by halving.
   * @type {(robot: Robot, rules: Rule[], safe: Pair, unsafe: Pair) => Pair} */
  function upTo(robot, rules, safe, unsafe) {
    let [low, high] = [safe, unsafe];
    for (let i = 0; i < HALVINGS; i += 1) {
      const middle = low.map((value, k) => (value + high[k]) / 2);
      if (violated(robot, rules, middle).length === 0) low = middle;
      else high = middle;
    }
    return low;
  }

  /** Straight on from where a boundary stopped the arm: how wide what is forbidden is, and what
      follows; null where nothing safe does.
   * @type {(robot: Robot, rules: Rule[], at: Pair, towards: Pair) => Behind | null} */
  function behind(robot, rules, at, towards) {
    const way = towards.map((value, k) => value - at[k]);
    const length = Math.hypot(...way);
    if (length === 0) return null;
    let barred = -1;
    for (let s = STEP / 4; s <= Math.max(length, BEHIND); s += STEP / 4) {
      const pair = at.map((value, k) => value + (s / length) * way[k]);
      const isBarred = violated(robot, rules, pair).length > 0;
      if (isBarred && barred < 0) barred = s;
      if (!isBarred && barred >= 0)
        return { pair, width: s - barred, region: qboundParts.regionAt(robot, pair) };
    }
    return null;
  }

  /* --- the figure -------------------------------------------------------------------------------- */

  const LONGEST =
    "B4 stops the arm: points 12 and 13 would be nearer than 0.25 cm. Behind it, 10.0° further on, lies region 5: the points allow it as they do region 1, and no way leads there. Overlap: the base and link 1, 10.00 cm deep.";

  /** @type {(robot: Robot, wall: Wall) => string} */
  function reasonOf(robot, wall) {
    const names = wall.points.map((i) => robot.points[i].name);
    if (wall.kind === "half-space") return `point ${names[0]} would pass the wall`;
    const required = wall.kind === "pair" ? wall.required : wall.clearance;
    const least = `${qboundEngine.number(required, 2)} ${robot.length_unit}`;
    return `points ${names[0]} and ${names[1]} would be nearer than ${least}`;
  }

  /** @type {(robot: Robot, slid: Slid, next: Behind | null, here: number | null) => string} */
  function stopText(robot, { by }, next, here) {
    const [wall] = by;
    const text = `${wall.name} stops the arm: ${reasonOf(robot, wall)}. `;
    if (!next || next.region === null || next.region === here)
      return `${text}What lies behind is forbidden, too.`;
    const width = qboundParts.degrees(next.width);
    return `${text}Behind it, ${width} further on, lies region ${next.region}: the points allow it as they do region ${here}, and no way leads there.`;
  }

  /** @type {FigureKind} */
  function show(root, _, { robot }) {
    if (!robot) throw new Error("This figure needs a robot.");
    showRegions(root, robot);
  }

  /** @type {(root: HTMLElement, robot: Robot) => void} */
  function showRegions(root, robot) {
    const { element, mount } = qboundEngine;
    const { buttons, regionAt, statusLine } = qboundParts;
    const rules = rulesOf(robot);
    const arm = mount(root, robot, {
      controls: [],
      show: { workspace: false, polygon: false },
      q: robot.q,
    });
    const status = statusLine(LONGEST);
    let [at, mine] = [arm.pair(), false];
    /** @type {SVGPathElement[]} */
    let patches = [];
    /** @type {SVGPathElement | null} */
    let barredWay = null;

    /** @type {(pair: Pair) => void} */
    function put(pair) {
      mine = true;
      arm.move(pair);
      mine = false;
      at = arm.pair();
    }

    /** @type {(lit: string | null) => void} */
    function light(lit) {
      arm.state.hover = lit;
      mine = true;
      arm.refresh();
      mine = false;
    }

    /** The reader moved the arm: let it go as far as it can. */
    function follow() {
      if (mine || qboundParts.isSame(arm.pair(), at)) return;
      const slid = slide(robot, rules, at, arm.pair());
      arm.state.hover = slid.by[0]?.name ?? null;
      put(slid.at);
      const here = regionAt(robot, at);
      const next = slid.by.length > 0 ? behind(robot, rules, slid.at, slid.goal) : null;
      drawBarred(slid);
      mark(here);
      tell(
        slid.by.length > 0
          ? stopText(robot, slid, next, here)
          : `Region ${here}${here === 1 ? ", that of the home pose" : ""}. Drag the dot to its edge.`,
        slid.by.length > 0,
      );
    }

    /** @type {(words: string, isBarred: boolean) => void} */
    function tell(words, isBarred) {
      const overlap = qboundEngine.overlapText(robot, arm.state.q);
      status.say(`${words} ${overlap}`.trim(), isBarred || overlap !== "");
    }

    /** @type {(slid: Slid) => void} */
    function drawBarred({ at: stopped, by, goal }) {
      const ends = by.length > 0 ? [stopped, goal].map(arm.joints.at) : [];
      barredWay?.setAttribute("d", qboundEngine.pathText(ends));
    }

    /** @type {(region: number | null) => void} */
    function mark(region) {
      for (const [i, patch] of patches.entries()) patch.classList.toggle("here", i + 1 === region);
      for (const [i, button] of [...choice.children].entries())
        button.setAttribute("aria-pressed", String(i + 1 === region));
    }

    function draw() {
      const { layer, make, pathText } = qboundEngine;
      for (const group of root.querySelectorAll("g.regions")) group.remove();
      const group = layer(arm.joints, "regions");
      patches = robot.components.map(({ loops }) => {
        const d = loops.map((loop) => {
          const points = loop.flatMap((arc) => arc.points);
          return qboundParts.turns(robot).map((by) =>
            pathText(
              points.map((p) => arm.joints.at(p.map((v, k) => v + by[k]))),
              true,
            ),
          );
        });
        return group.appendChild(make("path", { class: "region", d: d.flat().join("") }));
      });
      for (const i of robot.components.keys()) nameRegion(group, i);
      barredWay = group.appendChild(make("path", { class: "barred" }));
      mark(regionAt(robot, at));
    }

    /** Write a region's number at its centroid, or a little beside it where a name stands there.
     * @type {(group: SVGGElement, i: number) => void} */
    function nameRegion(group, i) {
      const { centroid } = robot.components[i];
      const places = qboundParts
        .turns(robot)
        .map((by) => arm.joints.at((centroid ?? []).map((value, k) => value + by[k])));
      const [place] = places.filter(([x, y]) => inside(arm.joints.box, x, y));
      if (!place) return;
      const text = qboundEngine.make("text", { class: "region-name", x: place[0] }, `${i + 1}`);
      group.append(text);
      const names = [...arm.joints.svg.querySelectorAll(".arc-name, .line-name")];
      const taken = names.map((name) => name.getBoundingClientRect());
      for (const shift of [0, 20, -20, 34, -34]) {
        text.setAttribute("y", String(place[1] + 6 + shift));
        const box = text.getBoundingClientRect();
        if (!taken.some((other) => overlap(box, other))) break;
      }
    }

    /** @type {(i: number) => void} */
    function lift(i) {
      const { centroid } = robot.components[i];
      if (!centroid) return;
      drawBarred({ at: centroid, by: [], goal: centroid });
      put(centroid);
      light(null);
      mark(i + 1);
      const text =
        i === 0
          ? "The arm stands in region 1, that of the home pose."
          : `The arm was lifted into region ${i + 1}. No way leads from here to region 1.`;
      tell(text, false);
    }

    const choice = buttons(
      ...robot.components.map((_, i) => /** @type {Press} */ ([`${i + 1}`, () => lift(i)])),
    );
    root.querySelector(".status")?.replaceWith(status.seen);
    root.querySelector(".unseen[role=status]")?.replaceWith(status.spoken);
    root.append(element("p", { className: "put" }, "Put the arm into region"), choice);
    root.addEventListener("qbound-draw", draw);
    root.addEventListener("qbound-pose", follow);
    draw();
    tell("Region 1, that of the home pose. Drag the dot to its edge.", false);
  }

  /** @type {(box: Picture["box"], x: number, y: number) => boolean} */
  function inside({ left, right, top, bottom }, x, y) {
    return x >= left && x <= right && y >= top && y <= bottom;
  }

  /** @type {(a: DOMRect, b: DOMRect) => boolean} */
  function overlap(a, b) {
    return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  }

  qboundFigures.regions = Object.assign(show, { rulesOf, violated, slide, behind });
}
