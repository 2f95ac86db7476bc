"use strict";
/* Figure 11: random poses, drawn where they put the tool. A place that is pressed shows both postures
   that reach it: which is safe, in which region, or what forbids it. */
{
  const NEAR = 14; // pixels: a press so near to a dot means the dot

  /* --- arithmetic: tests/book/test_play_arithmetic.py runs it beside the library -------------------- */

  /** The other posture at the tool's place; null where a limit forbids it or there is none.
   * @type {(robot: Robot, pair: Pair) => Pair | null} */
  function otherPosture(robot, pair) {
    const map = qboundEngine.toolMap(robot, robot.q);
    return qboundEngine.otherPosture(robot, map, qboundEngine.armOf(map), pair);
  }

  /** Whether a pose is safe, in which region it lies, and what it violates.
   * @type {(robot: Robot, pair: Pair) => Judged} */
  function judge(robot, pair) {
    const { margins, withPair } = qboundEngine;
    const found = margins(robot, withPair(robot, robot.q, pair));
    const bad = found.filter((one) => one.used && one.value < 0).map((one) => one.name);
    const region = bad.length > 0 ? null : qboundParts.regionAt(robot, pair);
    const overlap = qboundEngine.overlapText(robot, withPair(robot, robot.q, pair)) !== "";
    return { pair, safe: bad.length === 0, region, violated: bad, overlap };
  }

  /** The first dot of the sample with one safe posture, to begin with.
   * @type {(robot: Robot) => Pair} */
  function firstMixed(robot) {
    const mixed = qboundEngine.randomPairs(robot).find((pair) => {
      const other = otherPosture(robot, pair);
      return other && judge(robot, pair).safe && !judge(robot, other).safe;
    });
    return mixed ?? robot.free.map((j) => robot.q[j]);
  }

  /* --- the figure ------------------------------------------------------------------------------- */

  const LONGEST =
    "The posture in full colour is not allowed, B1 and B3 and B7 forbid it, and its links overlap (q1 −100.0°, q2 −100.0°). The pale one is allowed by the points, in region 2, cut off from home, and its links overlap (q1 −100.0°, q2 −100.0°).";

  /** @type {(robot: Robot, judged: Judged) => string} */
  function verdictText(robot, { safe, region, violated, overlap }) {
    const links = overlap ? ", and its links overlap" : "";
    if (!safe) {
      const forbid = violated.length > 1 ? "forbid" : "forbids";
      return `not allowed, ${violated.join(" and ")} ${forbid} it${links}`;
    }
    if (region === null || robot.components.length < 2) return `allowed${links}`;
    const where = region === 1 ? " with home" : ", cut off from home";
    return `allowed by the points, in region ${region}${where}${links}`;
  }

  /** @type {(robot: Robot, pair: Pair) => string} */
  function poseText(robot, pair) {
    return pair
      .map((value, k) => {
        const joint = robot.joints[robot.free[k]];
        const shown =
          joint.kind === "revolute"
            ? qboundParts.degrees(value)
            : `${qboundEngine.number(value, 2)} ${robot.length_unit}`;
        return `${joint.name} ${shown}`;
      })
      .join(", ");
  }

  /** @type {FigureKind} */
  function show(root, _, { robot }) {
    if (!robot) throw new Error("This figure needs a robot.");
    showPostures(root, robot);
  }

  /** @type {(root: HTMLElement, robot: Robot) => void} */
  function showPostures(root, robot) {
    const { element, make, mount, pixelOf, placeAt, withPair } = qboundEngine;
    const { buttons, statusLine } = qboundParts;
    const arm = mount(root, robot, {
      controls: [],
      show: { workspace: false, polygon: false, sample: true },
      q: withPair(robot, robot.q, firstMixed(robot)),
    });
    const status = statusLine(LONGEST);
    /** @type {PlanePicture | null} */
    let second = null;
    /** @type {SVGCircleElement | null} */
    let dot = null;

    function draw() {
      second = qboundParts.armParts(robot, arm.plane);
      const group = second.spine.parentElement;
      group?.classList.add("second");
      if (group) arm.plane.spine.parentElement?.before(group);
      dot = make("circle", { class: "second-dot", r: 7 });
      arm.joints.group.before(dot);
      follow();
    }

    function follow() {
      const here = judge(robot, arm.pair());
      const pair = otherPosture(robot, arm.pair());
      const other = pair && judge(robot, pair);
      root.classList.toggle("alone", other === null);
      if (other && second && dot) {
        placeAt(dot, arm.joints.at(other.pair), "c");
        for (const part of [dot, second.spine.parentElement])
          part?.classList.toggle("unsafe", !other.safe);
        qboundParts.moveArm(robot, second, withPair(robot, robot.q, other.pair));
      }
      status.say(
        `The posture in full colour is ${verdictText(robot, here)} (${poseText(robot, here.pair)}). ` +
          (other
            ? `The pale one is ${verdictText(robot, other)} (${poseText(robot, other.pair)}).`
            : "No other reaches this place within the limits."),
        !here.safe,
      );
    }

    /** The dot nearest to a place of a picture, if one is near.
     * @type {(pixel: Point, place: (one: SamplePose) => Point) => SamplePose | null} */
    function dotAt(pixel, place) {
      let [best, least] = [/** @type {SamplePose | null} */ (null), NEAR];
      for (const one of arm.state.sample) {
        const [x, y] = place(one);
        const gap = Math.hypot(x - pixel[0], y - pixel[1]);
        if (gap < least) [best, least] = [one, gap];
      }
      return best;
    }

    /** @type {(picture: "joints" | "plane") => (one: SamplePose) => Point} */
    const placeIn = (picture) => (one) =>
      picture === "joints" ? arm.joints.at(one.pair) : arm.plane.at(one.tool);

    for (const name of /** @type {("joints" | "plane")[]} */ (["joints", "plane"])) {
      const { svg } = arm[name];
      svg.addEventListener("click", (event) => {
        const found = dotAt(pixelOf(svg, event), placeIn(name));
        if (found) arm.move(found.pair);
      });
    }
    let turn = 0;
    /** Another dot with one safe posture and one that is not, or with two that are alike.
     * @type {(wanted: (one: Judged, other: Judged) => boolean) => void} */
    function next(wanted) {
      const all = arm.state.sample;
      for (let i = 1; i <= all.length; i += 1) {
        const { pair } = all[(turn + i) % all.length];
        const other = otherPosture(robot, pair);
        if (!other || !wanted(judge(robot, pair), judge(robot, other))) continue;
        turn = (turn + i) % all.length;
        arm.move(pair);
        return;
      }
    }

    root.querySelector(".status")?.replaceWith(status.seen);
    root.querySelector(".unseen[role=status]")?.replaceWith(status.spoken);
    root.append(
      buttons(
        ["A dot with one allowed posture", () => next((a, b) => a.safe !== b.safe)],
        ["with two", () => next((a, b) => a.safe && b.safe)],
        ["with none", () => next((a, b) => !a.safe && !b.safe)],
      ),
      element("p", { className: "hint" }, "Press a dot, or drag the tool."),
    );
    root.addEventListener("qbound-draw", draw);
    root.addEventListener("qbound-pose", follow);
    draw();
  }

  qboundFigures.postures = Object.assign(show, { otherPosture, judge });
}
