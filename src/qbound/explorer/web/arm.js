/* The picture of the arm in its plane of motion. */

/** The part of the plane that the arm can reach, its bodies included, whatever joint moves.
 * @type {(robot: Robot) => number[][]} */
function planeBox(robot) {
  const [xs, ys] = [[0], [0]];
  const steps = Array.from({ length: 17 }, (_, i) => i / 16);
  for (const q of posesOfHeld(robot)) {
    for (const a of steps) {
      for (const b of steps) {
        const pair = robot.views.map((v, k) => v.low + (k ? b : a) * (v.high - v.low));
        for (const [x, y] of planePlaces(robot, withPair(robot, q, pair))) {
          xs.push(x);
          ys.push(y);
        }
      }
    }
  }
  const pad = 0.04 * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
  return [
    [Math.min(...xs) - pad, Math.max(...xs) + pad],
    [Math.min(...ys) - pad, Math.max(...ys) + pad],
  ];
}

/** The pose that the page opens with, and each held joint on its own at places of its range.
 * @type {(robot: Robot) => Pose[]} */
function posesOfHeld(robot) {
  const others = robot.joints.flatMap((joint, j) => {
    if (robot.free.includes(j)) return [];
    const [low, high] = joint.limits || [-Math.PI, Math.PI];
    return [0, 0.25, 0.5, 0.75, 1].map((s) =>
      robot.q.map((value, i) => (i === j ? low + s * (high - low) : value)),
    );
  });
  return [robot.q, ...others];
}

/** Everything of the arm that takes room in the plane.
 * @type {(robot: Robot, q: Pose) => Point[]} */
function planePlaces(robot, q) {
  const [found, axes] = [framesOf(robot, q), viewAxes(robot, q)];
  const corners = robot.bodies.flatMap((body) =>
    body.outline.map((p) => placeIn(found[body.frame], p)),
  );
  const points = robot.points.map((point) => placeIn(found[point.frame], point.at));
  return [...corners, ...points, ...found.map((frame) => frame.place)].map((p) => project(axes, p));
}

/** @type {(robot: Robot, q: Pose, pair: Pair) => Pose} */
function withPair(robot, q, pair) {
  const pose = [...q];
  robot.free.forEach((j, k) => {
    pose[j] = pair[k];
  });
  return pose;
}

/** @type {(svg: SVGSVGElement, robot: Robot, state: State, slice: Slice, box: number[][]) => PlanePicture} */
function drawPlane(svg, robot, state, slice, box) {
  const fitted = picture(svg, box, { left: 8, right: 8, top: 8, bottom: 26 }, true);
  const drawn = {
    ...fitted,
    box: { left: 0, top: 0, right: fitted.width, bottom: fitted.height },
  };
  clear(drawn);
  drawScaleBar(robot, drawn);
  if (state.show.workspace && slice.regular) drawWorkspace(drawn, slice);
  const walls = drawWalls(robot, drawn, state);
  if (state.show.sample)
    drawMarks(layer(drawn, "sample"), state.sample, (one) => drawn.at(one.tool));
  const path = layer(drawn, "tool-path").appendChild(make("path", { class: "path" }));
  const ghost = layer(drawn, "arm-ghost").appendChild(make("path", { class: "ghost" }));
  const arm = addArm(robot, drawn);
  const mark = make("rect", { class: "handle", x: -7, y: -7, width: 14, height: 14, rx: 2 });
  return { ...drawn, ...arm, ...handle(svg, mark), walls, path, ghost };
}

/** @type {(robot: Robot, drawn: Picture) => void} */
function drawScaleBar(robot, drawn) {
  const group = layer(drawn, "axes", false);
  const [left] = drawn.from([0, 0]);
  const [right] = drawn.from([drawn.width, 0]);
  const unit = 10 ** Math.floor(Math.log10((right - left) / 4));
  const length = unit * ([5, 2].find((k) => k * unit <= (right - left) / 4) ?? 1);
  const pixels = drawn.at([length, 0])[0] - drawn.at([0, 0])[0];
  const y = drawn.height - 10;
  group.append(make("path", { class: "wall", d: `M12 ${y - 4}v8M12 ${y}h${pixels}m0 -4v8` }));
  const words = `${Number(length.toPrecision(2))} ${robot.length_unit}`;
  group.append(make("text", { x: 20 + pixels, y: y + 4 }, words));
}

/** @type {(drawn: Picture, slice: Slice) => void} */
function drawWorkspace(drawn, slice) {
  const group = layer(drawn, "images");
  for (const image of [slice.images.positive, slice.images.negative]) {
    const d = image.map((points) => pathText(points.map(drawn.at), true)).join("");
    group.append(make("path", { class: "workspace", d }));
  }
}

/** Walls of the plane: the line, and a tint of what lies beyond it.
 * @type {(robot: Robot, drawn: Picture, state: State) => SVGPathElement[]} */
function drawWalls(robot, drawn, state) {
  const group = layer(drawn, "walls");
  const corners = [
    [0, 0],
    [drawn.width, 0],
    [drawn.width, drawn.height],
    [0, drawn.height],
  ].map(drawn.from);
  const places = pointPlaces(robot, state.q);
  const axes = viewAxes(robot, state.q);
  /** @type {SVGTextElement[]} */
  const names = [];
  const lines = robot.boundaries.flatMap((wall) => {
    if (wall.kind === "pair") return [];
    const normal = project(axes, wall.normal);
    const offset = wall.offset - dot(axes[2], wall.normal) * dot(axes[2], places[wall.points[0]]);
    /** @type {Side} */
    const side = ([x, y]) => normal[0] * x + normal[1] * y - offset;
    const beyond = pathText(clipBelow(corners, side).map(drawn.at), true);
    if (wall.used) group.append(make("path", { class: "beyond", d: beyond }));
    const ends = lineThrough(corners, side).map(drawn.at);
    const line = make("path", { class: wall.used ? "wall" : "wall unused", d: pathText(ends) });
    line.dataset.boundary = wall.name;
    group.append(line);
    if (ends.length === 2) names.push(group.appendChild(wallLabel(wall, ends, drawn)));
    return line;
  });
  thin(names, drawn.width);
  return lines;
}

/** Write a wall's name where its line leaves the picture on the right, or at the top.
 * @type {(wall: Wall, ends: Point[], drawn: Picture) => SVGTextElement} */
function wallLabel(wall, ends, drawn) {
  const [a, b] = ends;
  const [x, y] = a[0] - a[1] >= b[0] - b[1] ? a : b;
  const at = { x: Math.min(drawn.width - 8, x - 6), y: Math.max(16, y - 6), "text-anchor": "end" };
  return make("text", { class: "wall-name", ...at }, wall.name);
}

/** The part of a polygon where `side` is not positive (Sutherland and Hodgman).
 * @type {(corners: Point[], side: Side) => Point[]} */
function clipBelow(corners, side) {
  return corners.flatMap((a, i) => [
    ...(side(a) <= 0 ? [a] : []),
    ...crossing(a, corners[(i + 1) % corners.length], side),
  ]);
}

/** @type {(corners: Point[], side: Side) => Point[]} */
function lineThrough(corners, side) {
  return corners.flatMap((a, i) => crossing(a, corners[(i + 1) % corners.length], side));
}

/** Where the step from a to b changes sides, if it does.
 * @type {(a: Point, b: Point, side: Side) => Point[]} */
function crossing(a, b, side) {
  const [from, to] = [side(a), side(b)];
  const [isIn, staysIn] = [from <= 0, to <= 0];
  if (isIn === staysIn) return [];
  const share = from / (from - to);
  return [[a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]];
}

/** The elements that move with the pose; `placeArm` moves them.
 * @type {(robot: Robot, drawn: Picture) => ArmParts} */
function addArm(robot, drawn) {
  const group = layer(drawn, "arm");
  const links = robot.bodies.map((body) => `var(--links-${body.frame % 5})`);
  const parts = {
    bodies: links.map((fill) => make("polygon", { class: "body", fill })),
    spine: make("path", { class: "spine" }),
    axles: robot.joints.map(() => make("circle", { class: "axle", r: 5 })),
    gaps: robot.boundaries.map(() => make("line", { class: "gap", hidden: "" })),
    points: robot.points.map(({ radius }) =>
      make("circle", { class: radius > 0 ? "sphere" : "point", r: 3 }),
    ),
    names: robot.points.map(({ name }) => make("text", { class: "point-name" }, name)),
  };
  group.append(...Object.values(parts).flat());
  return parts;
}

/** Move the arm to a pose; `lit` are the points and boundaries that stand out.
 * @type {(robot: Robot, drawn: PlanePicture, state: State, lit: Lit) => void} */
function placeArm(robot, drawn, state, lit) {
  const [found, axes] = [framesOf(robot, state.q), viewAxes(robot, state.q)];
  /** @type {(place: Place) => Point} */
  const at = (place) => drawn.at(project(axes, place));
  for (const [i, { frame, outline }] of robot.bodies.entries()) {
    const corners = outline.map((p) => at(placeIn(found[frame], p)));
    drawn.bodies[i].setAttribute("points", corners.join(" "));
  }
  const places = robot.points.map((point) => at(placeIn(found[point.frame], point.at)));
  const spine = [...found.map((frame) => at(frame.place)), places[robot.tool]];
  drawn.spine.setAttribute("d", pathText(spine));
  for (const [j, axle] of drawn.axles.entries()) placeAt(axle, spine[j + 1], "c");
  for (const [i, place] of places.entries()) placePoint(robot, drawn, state, lit, i, place);
  for (const [i, wall] of robot.boundaries.entries()) placeGap(drawn.gaps[i], wall, places, lit);
  drawn.group.setAttribute("transform", `translate(${places[robot.tool].join(" ")})`);
}

/** @type {(element: SVGElement, point: Point, prefix?: string) => void} */
function placeAt(element, [x, y], prefix = "") {
  element.setAttribute(`${prefix}x`, String(x));
  element.setAttribute(`${prefix}y`, String(y));
}

/** @type {(robot: Robot, drawn: PlanePicture, state: State, lit: Lit, i: number, place: Point) => void} */
function placePoint(robot, drawn, state, lit, i, [x, y]) {
  const [mark, name, point] = [drawn.points[i], drawn.names[i], robot.points[i]];
  const size = drawn.at([point.radius, 0])[0] - drawn.at([0, 0])[0];
  placeAt(mark, [x, y], "c");
  mark.setAttribute("r", String(point.radius > 0 ? size : 3));
  mark.classList.toggle("lit", lit.points.has(i));
  name.classList.toggle("lit", lit.points.has(i));
  name.toggleAttribute("hidden", !state.show.names && !lit.points.has(i));
  const left = i % 2 === 0; // two points of a pair in contact lie at one place
  name.setAttribute("text-anchor", left ? "end" : "start");
  placeAt(name, [x + (left ? -7 : 7), y + (left ? 13 : -6)]);
}

/** A dashed line between the points of a pair that stands out.
 * @type {(line: SVGLineElement, wall: Wall, places: Point[], lit: Lit) => void} */
function placeGap(line, wall, places, lit) {
  const near = wall.kind === "pair" && lit.boundaries.has(wall.name);
  line.toggleAttribute("hidden", !near);
  if (!near) return;
  const [a, b] = wall.points.map((i) => places[i]);
  for (const [key, value] of Object.entries({ x1: a[0], y1: a[1], x2: b[0], y2: b[1] }))
    line.setAttribute(key, String(value));
  line.classList.toggle("lit", lit.violated.has(wall.name));
}

/** The arm without bodies at another pose: a line from base to tool.
 * @type {(robot: Robot, drawn: Picture, q: Pose) => string} */
function skeleton(robot, drawn, q) {
  const [found, axes] = [framesOf(robot, q), viewAxes(robot, q)];
  const places = [...found.map((frame) => frame.place), pointPlaces(robot, q)[robot.tool]];
  return pathText(places.map((p) => drawn.at(project(axes, p))));
}
