"use strict";
/* Figures 7 to 10, and the front page: the arm walks round the six points, and both pictures show
   how far it is. Options: data-start ("all", "right", "left", "mirror"), data-scale (0.95), and
   data-small, which plays by itself until the reader takes over. */
{
  const PIECES = 40; // of the tool's path between two stops
  const NEAR_SINGULAR = 0.02; // of the largest |det J|: here the arm looks stretched

  /* --- arithmetic: tests/book/test_play_arithmetic.py runs it beside the library -------------------- */

  /** The ways that a reader can choose, each with the points that it visits, counted from 1.
   * @type {(robot: Robot, scale: number) => Way[]} */
  function waysOf(robot, scale) {
    if (!robot.polygon) throw new Error("Traversals need a region with a polygon.");
    const { vertices, centroid, walks } = robot.polygon;
    const points = qboundEngine.scaledPolygon(vertices, scale, centroid);
    const names = ["all", "right", "left"].slice(0, walks.length);
    const ways = names.map((name, i) => ({
      name,
      labels: walks[i].map((k) => `point ${k + 1}`),
      stops: walks[i].map((k) => points[k]),
    }));
    const map = qboundEngine.toolMap(robot, robot.q);
    const arm = qboundEngine.armOf(map);
    if (arm.kind !== "rr") return ways;
    const stops = [points[0], qboundEngine.mirroredPose(arm, points[0])];
    return [...ways, { name: "mirror", labels: ["point 1", "its mirror image"], stops }];
  }

  /** The piece of a path on which a fraction of its length lies.
   * @type {(robot: Robot, stops: Pair[], done: number) => number} */
  function legOf(robot, stops, done) {
    return qboundEngine.legAt(qboundEngine.pieceLengths(robot, stops), done - 1e-12).leg;
  }

  /** The tool's places along a path of straight pieces, up to a fraction of its length.
   * @type {(robot: Robot, map: ToolMap, stops: Pair[], done: number) => Point[]} */
  function toolPath(robot, map, stops, done) {
    const count = Math.max(1, Math.ceil(PIECES * (stops.length - 1) * done));
    return Array.from({ length: count + 1 }, (_, i) =>
      qboundEngine.toolAt(map, qboundEngine.alongPath(robot, stops, (done * i) / count)),
    );
  }

  /** How long a path plays, and its stops.
   * @type {(robot: Robot, stops: Pair[]) => { seconds: number, places: number[] }} */
  function timesOf(robot, stops) {
    const { PACE, pieceLengths, stopsAt, sum } = qboundEngine;
    return { seconds: PACE * sum(pieceLengths(robot, stops)), places: stopsAt(robot, stops) };
  }

  /* --- drawing ---------------------------------------------------------------------------------- */

  /** Draw ways into both pictures of an explorer: whole and thin, and thick as far as they are done.
   * @type {(arm: Explorer, ways: Way[], mirrored: boolean) => Trace[]} */
  function drawWays(arm, ways, mirrored) {
    const { layer, make, pathText } = qboundEngine;
    const [left, right] = [arm.joints, arm.plane].map((picture) => layer(picture, "ways"));
    const { map, arm: links } = arm.slice;
    if (mirrored) {
      const way = ways.find(({ name }) => name === "right");
      const path = toolPath(arm.robot, map, way?.stops ?? [], 1);
      const d = pathText(path.map(([x, y]) => arm.plane.at([2 * links.c[0] - x, y])));
      right.append(make("path", { class: "way mirrored", d }));
    }
    return ways.map((way) => {
      const joint = pathText(way.stops.map(arm.joints.at));
      const tool = pathText(toolPath(arm.robot, map, way.stops, 1).map(arm.plane.at));
      left.append(make("path", { class: `way ${way.name}`, d: joint }));
      right.append(make("path", { class: `way ${way.name}`, d: tool }));
      const done = [left, right].map((group) =>
        group.appendChild(make("path", { class: `way done ${way.name}` })),
      );
      return { way, joints: done[0], plane: done[1] };
    });
  }

  /** @type {(arm: Explorer, trace: Trace, done: number) => void} */
  function drawDone(arm, { way, joints, plane }, done) {
    const { alongPath, pathText } = qboundEngine;
    const leg = done > 0 ? legOf(arm.robot, way.stops, done) : -1;
    const passed = way.stops.slice(0, leg + 1);
    const path = [...passed, alongPath(arm.robot, way.stops, done)];
    joints.setAttribute("d", done > 0 ? pathText(path.map(arm.joints.at)) : "");
    const tool = done > 0 ? toolPath(arm.robot, arm.slice.map, way.stops, done) : [];
    plane.setAttribute("d", pathText(tool.map(arm.plane.at)));
  }

  /* --- what is said ------------------------------------------------------------------------------ */

  /** @type {(arm: Explorer, way: Way, done: number) => string} */
  function stageText(arm, way, done) {
    const { determinant, number, toolAt } = qboundEngine;
    const leg = legOf(arm.robot, way.stops, done);
    const last = way.labels.length - 1;
    const on =
      done >= 1
        ? `At ${way.labels[last]}, the end`
        : `From ${way.labels[leg]} to ${way.labels[leg + 1]}`;
    const at = toolAt(arm.slice.map, arm.pair());
    const reach = Math.hypot(at[0] - arm.slice.arm.c[0], at[1] - arm.slice.arm.c[1]);
    const det = Math.abs(determinant(arm.slice.map, arm.pair()));
    const line =
      det <= NEAR_SINGULAR * arm.slice.largest ? " Both links lie in one line: det J = 0." : "";
    const overlap = qboundEngine.overlapText(arm.robot, arm.state.q);
    const words = `${on}. The tool is ${number(reach, 1)} ${arm.robot.length_unit} from joint 1.${line}`;
    return `${words} ${overlap}`.trim();
  }

  /* --- the figure -------------------------------------------------------------------------------- */

  const LONGEST =
    "From point 1 to its mirror image. The tool is 55.15 cm from joint 1. Both links lie in one line: det J = 0.";

  /** @type {Record<string, string>} */
  const NAMES = {
    all: "All six points",
    right: "On the right",
    left: "On the left",
    mirror: "To the mirror image",
  };

  /** @type {FigureKind} */
  function show(root, options, { robot }) {
    if (!robot) throw new Error("Traversals need a robot.");
    const scale = Number(options.scale ?? 0.95);
    const ways = waysOf(robot, scale);
    if ("small" in options) small(root, robot, ways);
    else full(root, robot, ways, scale, options.start ?? "all");
  }

  /** The front page's: it moves by itself, until the reader does.
   * @type {(root: HTMLElement, robot: Robot, ways: Way[]) => void} */
  function small(root, robot, [way]) {
    const { alongPath, element, mount, player } = qboundEngine;
    const arm = mount(root, robot, { controls: [], show: { polygon: false }, q: robot.q });
    const { seconds, places } = timesOf(robot, way.stops);
    const slowly = { seconds: 1.5 * seconds, places, loops: true };
    const button = element("button", { type: "button", textContent: "Play" });
    let put = arm.pair(); // where the path put the arm
    const walk = player(
      (done) => {
        put = alongPath(robot, way.stops, done);
        arm.move(put);
      },
      (runs) => {
        button.textContent = runs ? "Pause" : "Play";
      },
    );
    let asked = true; // whether it shall play while it is in sight
    const press = () => {
      asked = !walk.runs();
      if (asked) walk.play(slowly);
      else walk.stop();
    };
    const hint = "Drag the dot, or the tool.";
    button.addEventListener("click", press);
    root.append(element("p", { className: "buttons" }, button, element("span", {}, hint)));
    root.addEventListener("qbound-draw", () => drawWays(arm, [way], false));
    root.addEventListener("qbound-pose", () => {
      if (qboundParts.isSame(arm.pair(), put) || !walk.runs()) return;
      asked = false;
      walk.stop();
    });
    drawWays(arm, [way], false);
    walk.go(0);
    if (walk.calm()) return;
    new IntersectionObserver(([{ isIntersecting }]) => {
      if (isIntersecting && asked && !walk.runs()) walk.play(slowly);
      else if (!isIntersecting) walk.stop();
    }).observe(root);
  }

  /** @type {(root: HTMLElement, robot: Robot, ways: Way[], scale: number, start: string) => void} */
  function full(root, robot, ways, scale, start) {
    const { alongPath, element, mount, player } = qboundEngine;
    const { buttons, statusLine, tick } = qboundParts;
    const arm = mount(root, robot, {
      controls: [],
      show: { polygon: true, workspace: false },
      scale,
    });
    let way = ways.find(({ name }) => name === start) ?? ways[0];
    let [done, mirrored, put] = [0, false, arm.pair()];
    /** @type {Trace[]} */
    let traces = [];

    const status = statusLine(LONGEST);
    const along = element("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "0.001",
      value: "0",
    });
    along.ariaLabel = "Along the path";
    const choice = buttons(
      ...ways.map(({ name }) => /** @type {Press} */ ([NAMES[name], () => choose(name)])),
    );
    const play = buttons(["Play", () => (walk.runs() ? walk.stop() : begin())]);
    const compare = tick("The right-hand path, mirrored", false, (checked) => {
      mirrored = checked;
      draw();
    });
    const walk = player(
      (value) => {
        done = value;
        put = alongPath(robot, way.stops, done);
        arm.move(put);
        along.value = String(done);
        for (const trace of traces) if (trace.way === way) drawDone(arm, trace, done);
        tell();
      },
      (runs) => {
        play.firstElementChild?.replaceChildren(runs ? "Pause" : "Play");
      },
    );

    function begin() {
      walk.play(timesOf(robot, way.stops));
    }

    /** @type {(name: string) => void} */
    function choose(name) {
      way = ways.find((one) => one.name === name) ?? way;
      done = 0;
      draw();
      walk.go(0);
    }

    /** The way that plays, above the others; the two sides are shown together. */
    function draw() {
      const together = ["right", "left"].includes(way.name);
      const others = ways.filter(({ name }) => together && ["right", "left"].includes(name));
      arm.state.mirror = way.name === "mirror" ? way.stops[1] : null;
      for (const group of root.querySelectorAll("g.ways")) group.remove();
      traces = drawWays(arm, [...others.filter((one) => one !== way), way], mirrored && together);
      for (const trace of traces) if (trace.way === way) drawDone(arm, trace, done);
      compare.hidden = !together;
      for (const [i, { name }] of ways.entries())
        choice.children[i].setAttribute("aria-pressed", String(name === way.name));
    }

    function tell() {
      status.say(stageText(arm, way, done), false);
    }

    root.querySelector(".status")?.replaceWith(status.seen);
    root.querySelector(".unseen[role=status]")?.replaceWith(status.spoken);
    root.append(choice, element("div", { className: "along" }, play, along), compare);
    along.addEventListener("input", () => walk.go(Number(along.value)));
    root.addEventListener("qbound-draw", draw);
    root.addEventListener("qbound-pose", () => {
      if (qboundParts.isSame(arm.pair(), put)) return;
      walk.stop();
      status.say("You moved the arm. Play goes on from where the path stood.", false);
    });
    choose(way.name);
  }

  qboundFigures.traversals = Object.assign(show, { waysOf, legOf, toolPath });
}
