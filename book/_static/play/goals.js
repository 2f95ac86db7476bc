"use strict";
/* The front page: bring the tool to a ring. The arm stops where a link would touch an obstacle, and the
   map of joint space shows why one ring cannot be reached. */
{
  const NEAR = 0.12; // of the reach: a hand so near to a ring wants to go there
  const THERE = 0.03; // of the reach: the tool is on the ring

  const LONGEST =
    "No path to ring B in the computed region. Every pose that reaches it lies in the grey part of the map or hits an obstacle; the arm is in the blue part, and no way leads from blue to grey.";

  /** @type {(robot: Robot, wall: Wall) => string} */
  function touchText(robot, wall) {
    if (wall.kind !== "bodies") return `${wall.name} stops the arm.`;
    const [one, other] = wall.bodies.map((i) => qboundEngine.bodyName(robot, i));
    return `The ${one} touches the ${other}.`;
  }

  /** @type {(ring: Ring) => string} */
  function answerText({ name, poses, path }) {
    if (path)
      return `Ring ${name} can be reached. Fold the arm to pass the post, or let it be shown.`;
    const hits = poses.some(({ answer }) => answer === "infeasible") ? " or hits an obstacle" : "";
    return `No path to ring ${name} in the computed region. Every pose that reaches it lies in the grey part of the map${hits}; the arm is in the blue part, and no way leads from blue to grey.`;
  }

  /** @type {FigureKind} */
  function show(root, _, { robot: given, own }) {
    if (!given || !own) throw new Error("This figure needs a robot and its rings.");
    const { element, layer, make, mount, project, pointPlaces, viewAxes, withPair } = qboundEngine;
    const { buttons, moveTo, statusLine } = qboundParts;
    const robot = given;
    const rings = /** @type {Ring[]} */ (own.rings);
    const { rulesOf, slide } = /** @type {RegionsKind} */ (
      /** @type {unknown} */ (qboundFigures.regions)
    );
    const rules = rulesOf(robot);
    const arm = mount(root, robot, { controls: [], show: { workspace: false, polygon: false } });
    const status = statusLine(LONGEST);
    const proof = element("p", { className: "hint proof-line" });
    let [at, mine] = [arm.pair(), false];
    /** @type {Ring | null} */
    let chosen = null;

    /** @type {(pair: Pair) => Point} */
    function toolOf(pair) {
      const pose = withPair(robot, robot.q, pair);
      return project(viewAxes(robot, pose), pointPlaces(robot, pose)[robot.tool]);
    }

    /** @type {(place: Point, share: number) => Ring | null} */
    function ringAt(place, share) {
      const near = share * robot.reach;
      return rings.find(({ at: [x, y] }) => Math.hypot(x - place[0], y - place[1]) < near) ?? null;
    }

    /** @type {(ring: Ring | null) => void} */
    function choose(ring) {
      chosen = ring;
      for (const mark of root.querySelectorAll("[data-ring]"))
        mark.classList.toggle("chosen", mark.getAttribute("data-ring") === ring?.name);
      const files = ring?.poses.flatMap(({ file }) => (file && !ring.path ? [file] : [])) ?? [];
      const links = files.flatMap((file, i) => [
        i > 0 ? " and " : "",
        element("a", { href: `_static/${file}`, download: "" }, `certificate ${i + 1}`),
      ]);
      const words = files.length > 1 ? "of both poses" : "of the pose";
      const proved = [
        `This is proved ${words} that reach${files.length > 1 ? "" : "es"} the ring: `,
        ...links,
        ".",
      ];
      proof.replaceChildren(...(files.length > 0 ? proved : ["\u00a0"]));
    }

    /** The reader moved the arm: let it go as far as it can. */
    function follow() {
      if (mine || qboundParts.isSame(arm.pair(), at)) return;
      if (arm.isPlaying()) {
        at = arm.pair(); // a path that is proved
        return;
      }
      const slid = slide(robot, rules, at, arm.pair());
      mine = true;
      arm.state.hover = slid.by[0]?.name ?? null;
      arm.move(slid.at);
      mine = false;
      at = arm.pair();
      const [here, wanted] = [ringAt(toolOf(at), THERE), ringAt(toolOf(slid.goal), NEAR)];
      const [wall] = slid.by;
      const isBarred = wall !== undefined && here === null;
      if (here) choose(here);
      else if (wanted && isBarred) choose(wanted);
      if (here) status.say(`There: the tool is on ring ${here.name}.`, false);
      else if (isBarred && chosen)
        status.say(`${touchText(robot, wall)} ${answerText(chosen)}`, true);
      else if (isBarred) status.say(touchText(robot, wall), true);
      else status.say("Bring the square, the tool of the arm, to a ring.", false);
    }

    /** Both poses of a ring in the map, and the ring in the workspace. */
    function draw() {
      for (const group of root.querySelectorAll("g.rings")) group.remove();
      const [map, plane] = [arm.joints, arm.plane].map((drawn) => layer(drawn, "rings"));
      arm.joints.group.before(map);
      arm.plane.group.before(plane);
      /** @type {(group: SVGGElement, ring: Ring, place: Point, kind: string) => void} */
      const mark = (group, { name }, place, kind) => {
        const one = make("g", { class: `ring ${kind}`, "data-ring": name });
        const text = make("text", { y: 4, "text-anchor": "middle" }, name);
        one.append(make("circle", { r: 10 }), text);
        moveTo(one, place);
        group.append(one);
      };
      const axes = viewAxes(robot, robot.q);
      for (const { name, frame, outline } of robot.bodies) {
        if (frame !== 0) continue; // the obstacles stand still, and so do their names
        const corners = outline.map((place) => arm.plane.at(project(axes, place)));
        const [xs, ys] = [0, 1].map((k) => corners.map((corner) => corner[k]));
        const x = (Math.min(...xs) + Math.max(...xs)) / 2;
        const look = { class: "point-name", "text-anchor": "middle", x, y: Math.min(...ys) - 5 };
        plane.append(make("text", look, name));
      }
      for (const ring of rings) {
        mark(plane, ring, arm.plane.at(ring.at), "");
        for (const { q, answer } of ring.poses) mark(map, ring, arm.joints.at(q), answer);
      }
      choose(chosen);
    }

    function goHome() {
      at = robot.free.map((j) => robot.q[j]);
      mine = true;
      arm.move(at);
      mine = false;
    }

    /** @type {(ring: Ring) => void} */
    function ask(ring) {
      goHome();
      choose(ring);
      status.say(answerText(ring), !ring.path);
      if (ring.path) arm.play(ring.path, 0, () => {});
    }

    root.querySelector(".status")?.replaceWith(status.seen);
    root.querySelector(".unseen[role=status]")?.replaceWith(status.spoken);
    const words =
      "Each point of the map is a pose of both joints. Blue: what the arm can reach from where it stands. Grey: poses that hit nothing, but cut off from it. Empty: a link hits an obstacle. A ring is marked once for each posture, elbow up or down, that reaches it.";
    const asking = rings.map(
      (ring) => /** @type {Press} */ ([`Is there a path to ${ring.name}?`, () => ask(ring)]),
    );
    root.append(
      element("p", { className: "hint" }, words),
      proof,
      buttons(...asking, ["Start again", goHome]),
    );
    root.addEventListener("qbound-draw", draw);
    root.addEventListener("qbound-pose", follow);
    draw();
    status.say("Bring the square, the tool of the arm, to a ring.", false);
  }

  qboundFigures.goals = Object.assign(show, { answerText });
}
