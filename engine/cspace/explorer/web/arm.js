/* The picture of the arm in its plane of motion. */

/** The part of the plane that the arm can reach, its bodies included, whatever joint moves.
 * @type {(robot: Robot) => number[][]} */
function planeBox(robot) {
  const box = [
    [0, 0],
    [0, 0],
  ];
  const steps = Array.from({ length: 17 }, (_, i) => i / 16);
  for (const q of posesOfHeld(robot)) {
    for (const a of steps) {
      for (const b of steps) {
        const pair = robot.views.map((v, k) => v.low + (k ? b : a) * (v.high - v.low));
        for (const place of planePlaces(robot, withPair(robot, q, pair)))
          place.forEach((value, k) => {
            box[k] = [Math.min(box[k][0], value), Math.max(box[k][1], value)];
          });
      }
    }
  }
  const pad = 0.04 * Math.max(...box.map(([low, high]) => high - low));
  return box.map(([low, high]) => [low - pad, high + pad]);
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

/** @type {(svg: SVGSVGElement, robot: Robot, state: State, slice: Slice, box: number[][]) => PlanePicture} */
function drawPlane(svg, robot, state, slice, box) {
  const drawn = wholePicture(svg, box, 26);
  const axes = viewAxes(robot, state.q);
  if (robot.plane.oblique) drawFloor(robot, drawn, axes);
  else drawGround(robot, drawn, axes);
  drawScaleBar(drawn, robot.length_unit);
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

/** @type {(drawn: Picture, unit: string) => void} */
function drawScaleBar(drawn, unit) {
  const group = layer(drawn, "axes", false);
  const [left] = drawn.from([0, 0]);
  const [right] = drawn.from([drawn.width, 0]);
  const power = 10 ** Math.floor(Math.log10((right - left) / 4));
  const length = power * ([5, 2].find((k) => k * power <= (right - left) / 4) ?? 1);
  const pixels = drawn.at([length, 0])[0] - drawn.at([0, 0])[0];
  const y = drawn.height - 10;
  group.append(make("path", { class: "wall", d: `M12 ${y - 4}v8M12 ${y}h${pixels}m0 -4v8` }));
  const words = `${Number(length.toPrecision(2))} ${unit}`;
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

/** The ground, where the base has a body to stand on it and the picture is upright.
 * @type {(robot: Robot, drawn: Picture, axes: Place[]) => void} */
function drawGround(robot, drawn, axes) {
  const feet = robot.bodies.flatMap(({ frame, outline }) => (frame === 0 ? outline : []));
  if (feet.length === 0 || axes[1][2] < 0.99) return;
  const level = Math.min(...feet.map((foot) => project(axes, foot)[1]));
  const y = drawn.at([0, level])[1];
  const d = `M0 ${y}H${drawn.width}V${drawn.height}H0Z`;
  const line = make("path", { class: "ground-line", d: `M0 ${y}H${drawn.width}` });
  layer(drawn, "below").append(make("path", { class: "ground", d }), line);
}

/** The height of the floor: below the base, the arm's first frame.
 * @type {(robot: Robot) => number} */
function floorLevel(robot) {
  const feet = robot.bodies.flatMap(({ frame, outline }) => (frame === 0 ? outline : []));
  return Math.min(0, ...feet.map((foot) => foot[2]));
}

/** Two circles on the floor, which show how it lies where the arm is seen obliquely.
 * @type {(robot: Robot, drawn: Picture, axes: Place[]) => void} */
function drawFloor(robot, drawn, axes) {
  const level = floorLevel(robot);
  const [x, y] = robot.steps[0].origin;
  const rings = [0.5, 1].map((share) =>
    Array.from({ length: 60 }, (_, k) => {
      const [c, s] = turnedBy((k * TURN) / 60);
      const at = [x + share * robot.reach * c, y + share * robot.reach * s, level];
      return drawn.at(project(axes, at));
    }),
  );
  const d = rings.map((ring) => pathText(ring, true)).join("");
  layer(drawn, "below").append(make("path", { class: "floor", d }));
}

/** The arm's shadow straight below it, and the plumb line of the tool.
 * @type {(robot: Robot, q: Pose, at: (place: Place) => Point) => string} */
function shadowText(robot, q, at) {
  const level = floorLevel(robot);
  const tool = pointPlaces(robot, q)[robot.tool];
  const spine = [...framesOf(robot, q).map((frame) => frame.place), tool];
  const below = spine.map(([x, y]) => at([x, y, level]));
  return pathText(below) + pathText([at(tool), below[below.length - 1]]);
}

/** Walls of the plane: a line, with strokes on the side that is not feasible for the points it concerns.
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
  /** @type {Map<string, { walls: Wall[], ends: Point[] }>} */
  const labels = new Map();
  /** @type {Point[][]} */
  const hatched = [];
  const lines = robot.boundaries.flatMap((wall) => {
    if (wall.kind !== "half-space" || robot.plane.oblique) return [];
    const normal = project(axes, wall.normal);
    const depth = wall.body === null ? dot(axes[2], places[wall.points[0]]) : 0;
    const offset = wall.offset - dot(axes[2], wall.normal) * depth;
    /** @type {Side} */
    const side = ([x, y]) => normal[0] * x + normal[1] * y - offset;
    const ends = lineThrough(corners, side).map(drawn.at);
    if (wall.used && ends.length === 2 && !hatched.some((other) => isBeside(ends, other))) {
      hatched.push(ends);
      const strokes = make("path", { class: "beyond", d: strokesBelow(ends, normal) });
      group.append(ownColour(robot, strokes, wall.name));
    }
    const d = pathText(ends);
    const line = make("path", { class: wall.used ? "wall limit" : "wall limit unused", d });
    group.append(ownColour(robot, line, wall.name));
    if (ends.length === 2) {
      const there = labels.get(d) ?? { walls: [], ends };
      labels.set(d, { walls: [...there.walls, wall], ends });
    }
    return line;
  });
  const names = [...labels.values()].map(({ walls, ends }) => {
    const name = wallLabel(wallText(robot, walls), ends, drawn);
    return group.appendChild(ownColour(robot, name, walls[0].name));
  });
  thin(names, drawn.width);
  return lines;
}

/** Whether the strokes of one line would run into those of another.
 * @type {(ends: Point[], others: Point[]) => boolean} */
function isBeside(ends, others) {
  return ends.every((end, k) => Math.hypot(...minus(end, others[k])) < 14);
}

/** Short strokes along a line on the screen, on the side from which `normal` points away.
 * @type {(ends: Point[], normal: Point) => string} */
function strokesBelow([a, b], normal) {
  const size = Math.hypot(...minus(b, a));
  const along = minus(b, a).map((value) => value / size);
  const away = [-normal[0], normal[1]].map((value) => value / Math.hypot(...normal));
  const lean = along[0] + along[1] < 0 ? -1 : 1;
  const count = Math.floor(size / 10);
  const stroke = plus(
    away.map((value) => 8 * value),
    along.map((value) => -6 * lean * value),
  );
  return Array.from({ length: count + 1 }, (_, k) => {
    const from = plus(
      a,
      along.map((value) => 10 * k * value),
    );
    return pathText([from, plus(from, stroke)]);
  }).join("");
}

/** What a line stands for: the end that all names share, or a name and the point it concerns.
 * @type {(robot: Robot, walls: Wall[]) => string} */
function wallText(robot, walls) {
  const [first, ...others] = walls.map(({ name }) => name);
  const end = first.split(", ").at(-1) ?? first;
  if (others.length > 0) return others.every((name) => name.endsWith(end)) ? end : first;
  const [wall] = walls;
  const ofBody = wall.kind === "half-space" && wall.body !== null;
  const [i] = wall.points;
  const point = ofBody
    ? robot.bodies[wall.body ?? 0].name
    : i === robot.tool
      ? "tool"
      : `point ${robot.points[i].name}`;
  return end === first ? `${first} (${point})` : first;
}

/** Write a wall's name where its line leaves the picture on the right, or at the top.
 * @type {(name: string, ends: Point[], drawn: Picture) => SVGTextElement} */
function wallLabel(name, ends, drawn) {
  const [a, b] = ends;
  const [x, y] = a[0] - a[1] >= b[0] - b[1] ? a : b;
  const at = { x: Math.min(drawn.width - 8, x - 6), y: Math.max(16, y - 6), "text-anchor": "end" };
  return make("text", { class: "wall-name", ...at }, name);
}

/** @type {(corners: Point[], side: Side) => Point[]} */
function lineThrough(corners, side) {
  return corners.flatMap((a, i) => crossing(a, corners[(i + 1) % corners.length], side));
}

/** @type {(frame: number) => string} */
function linkColour(frame) {
  return `var(--links-${frame % 5})`;
}

/** Where the arm is seen obliquely, paint its balls from the farthest to the nearest.
 * @type {(drawn: PlanePicture, axes: Place[], places: Place[]) => void} */
function paintByDepth(drawn, axes, places) {
  const depths = places.map((place) => dot(axes[2], place));
  const order = drawn.points.map((_, i) => i).sort((a, b) => depths[a] - depths[b]);
  for (const i of order) drawn.points[i].parentNode?.insertBefore(drawn.points[i], drawn.names[0]);
}

/** The elements that move with the pose; `placeArm` moves them.
 * @type {(robot: Robot, drawn: Picture) => ArmParts} */
function addArm(robot, drawn) {
  const group = layer(drawn, "arm");
  const ids = `${drawn.svg.id}-${drawn.svg.querySelectorAll("clipPath").length}-`; // two arms, too
  const ballClass = robot.plane.oblique ? "sphere solid" : "sphere";
  const parts = {
    shadow: robot.plane.oblique ? [make("path", { class: "shadow" })] : [],
    bodies: robot.bodies.map(({ frame }) =>
      make("polygon", {
        class: frame === 0 ? "body fixed" : "body",
        fill: linkColour(frame),
      }),
    ),
    clips: robot.apart.map((_, k) => {
      const clip = make("clipPath", { id: `${ids}${k}` });
      clip.append(make("polygon", {}));
      return clip;
    }),
    overlaps: robot.apart.map((_, k) =>
      make("polygon", { class: "overlap", "clip-path": `url(#${ids}${k})`, hidden: "" }),
    ),
    spine: make("path", { class: "spine" }),
    axles: robot.steps.map(() => make("circle", { class: "axle", r: 5 })),
    gaps: robot.boundaries.map(({ name }) =>
      ownColour(robot, make("line", { class: "gap", hidden: "" }), name),
    ),
    nearest: robot.boundaries.flatMap(({ kind }) =>
      kind === "bodies"
        ? [0, 1].map(() => make("circle", { class: "nearest", r: 3, hidden: "" }))
        : [],
    ),
    points: robot.points.map(({ radius, frame }) =>
      make("circle", { class: radius > 0 ? ballClass : "point", r: 3, fill: linkColour(frame) }),
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
  const touching = new Set(
    robot.boundaries.flatMap((wall) => (lit.bold.has(wall.name) ? bodiesOf(wall) : [])),
  );
  for (const [i, { frame, outline }] of robot.bodies.entries()) {
    const corners = outline.map((p) => at(placeIn(found[frame], p)));
    drawn.bodies[i].setAttribute("points", corners.join(" "));
    drawn.bodies[i].classList.toggle("lit", touching.has(i));
  }
  const inSpace = robot.points.map((point) => placeIn(found[point.frame], point.at));
  const places = inSpace.map(at);
  const spine = [...found.map((frame) => at(frame.place)), places[robot.tool]];
  drawn.spine.setAttribute("d", pathText(spine));
  for (const path of drawn.shadow) path.setAttribute("d", shadowText(robot, state.q, at));
  for (const [j, axle] of drawn.axles.entries()) placeAt(axle, spine[j + 1], "c");
  const away = awayFromOther(robot, places, lit, (frame) =>
    robot.bodies.flatMap((body) =>
      body.frame === frame ? body.outline.map((p) => at(placeIn(found[frame], p))) : [],
    ),
  );
  for (const [i, place] of places.entries()) {
    placePoint(robot, drawn, state, lit, i, place);
    const beside = away.get(i);
    if (beside) placeNameBeside(drawn.names[i], place, beside);
  }
  if (robot.plane.oblique) paintByDepth(drawn, axes, inSpace);
  const placed = placedParts(robot, found);
  placeOverlaps(drawn, bodyGaps(robot, placed));
  const marks = [...drawn.nearest];
  for (const [i, wall] of robot.boundaries.entries()) {
    const near = lit.boundaries.has(wall.name);
    const ends = near ? gapEnds(robot, wall, found, placed).map(at) : [];
    placeGap(drawn.gaps[i], wall, ends, lit);
    if (wall.kind === "bodies") placeNearest(marks.splice(0, 2), wall, ends, lit);
  }
  drawn.group.setAttribute("transform", `translate(${places[robot.tool].join(" ")})`);
}

/** Bodies that are inside each other are red, and what they share is redder.
 * @type {(drawn: ArmParts, gaps: BodyGap[]) => void} */
function placeOverlaps({ bodies, clips, overlaps }, gaps) {
  const deep = new Set(gaps.flatMap((pair) => (pair.overlap ? pair.bodies : [])));
  for (const [i, body] of bodies.entries()) body.classList.toggle("deep", deep.has(i));
  for (const [k, pair] of gaps.entries()) {
    overlaps[k].toggleAttribute("hidden", !pair.overlap);
    if (!pair.overlap) continue;
    const [one, other] = pair.bodies.map((i) => bodies[i].getAttribute("points") ?? "");
    clips[k].firstElementChild?.setAttribute("points", one);
    overlaps[k].setAttribute("points", other);
  }
}

/** A body as people call it: a name that is a number is that of its frame.
 * @type {(robot: Robot, i: number) => string} */
function bodyName(robot, i) {
  const { name, frame } = robot.bodies[i];
  if (!/^\d+$/.test(name)) return name;
  return frame === 0 ? "the base" : `link ${frame}`;
}

/** Which two bodies are deepest inside each other at a pose; no words where all are apart.
 * @type {(robot: Robot, q: Pose) => string} */
function overlapText(robot, q) {
  const gaps = bodyGaps(robot, placedParts(robot, framesOf(robot, q)));
  const over = gaps.filter((pair) => pair.overlap);
  const deepest = leastBy(over, ({ gap }) => gap);
  if (!deepest) return "";
  const [one, other] = deepest.bodies.map((i) => bodyName(robot, i));
  const more = over.length > 1 ? `, and ${over.length - 1} more` : "";
  return `Overlap: ${one} and ${other}, ${number(-deepest.gap, 2)} ${robot.length_unit} deep${more}.`;
}

/** @type {(element: SVGElement, point: Point, prefix?: string) => void} */
function placeAt(element, [x, y], prefix = "") {
  set(element, { [`${prefix}x`]: x, [`${prefix}y`]: y });
}

/** @type {(robot: Robot, drawn: PlanePicture, state: State, lit: Lit, i: number, place: Point) => void} */
function placePoint(robot, drawn, state, lit, i, [x, y]) {
  const [mark, name, point] = [drawn.points[i], drawn.names[i], robot.points[i]];
  const size = drawn.at([point.radius, 0])[0] - drawn.at([0, 0])[0];
  placeAt(mark, [x, y], "c");
  mark.setAttribute("r", String(point.radius > 0 ? size : 3));
  mark.classList.toggle("lit", lit.points.has(i));
  mark.classList.toggle("named", lit.named.has(i));
  name.classList.toggle("lit", lit.points.has(i));
  name.toggleAttribute("hidden", !state.show.names && !lit.named.has(i));
  if (name.hasAttribute("hidden")) return;
  const left = i % 2 === 0; // two points of a pair in contact lie at one place
  name.setAttribute("text-anchor", left ? "end" : "start");
  placeAt(name, [x + (left ? -7 : 7), y + (left ? 13 : -6)]);
}

/** For both points of the closest pair, where its name has room: away from the other one; where the
    two lie at one place, on the side of its own body.
 * @type {(robot: Robot, places: Point[], lit: Lit, cornersOf: (frame: number) => Point[]) => Map<number, Point>} */
function awayFromOther(robot, places, lit, cornersOf) {
  const shown = lit.closest === null ? lit.boundaries : new Set([lit.closest]);
  const pair = robot.boundaries.find(({ name, kind }) => shown.has(name) && kind === "pair");
  if (!pair) return new Map();
  const [a, b] = pair.points;
  const [one, other] = pair.points.map((i) => cornersOf(robot.points[i].frame));
  const apart = minus(places[b], places[a]);
  const isOnePlace = Math.hypot(...apart) < 8 && one.length > 0 && other.length > 0;
  const gap = isOnePlace ? minus(centreOf(other), centreOf(one)) : apart;
  const size = Math.hypot(...gap) || 1;
  return new Map([
    [a, [-gap[0] / size, -gap[1] / size]],
    [b, [gap[0] / size, gap[1] / size]],
  ]);
}

/** @type {(points: Point[]) => Point} */
function centreOf(points) {
  return [0, 1].map((k) => sum(points.map((point) => point[k])) / points.length);
}

/** @type {(name: SVGTextElement, place: Point, direction: Point) => void} */
function placeNameBeside(name, [x, y], [dx, dy]) {
  name.setAttribute("text-anchor", dx > 0.3 ? "start" : dx < -0.3 ? "end" : "middle");
  placeAt(name, [x + 9 * dx, y + 12 * dy + 4]);
}

/** Both points of a pair; of bodies the two nearest places; of a wall what is nearest to it, and the
    place of the wall that it is nearest to.
 * @type {(robot: Robot, wall: Wall, found: Frame[], placed: PlacedPart[][]) => Place[]} */
function gapEnds(robot, wall, found, placed) {
  if (wall.kind === "bodies") {
    const [u, v] = robot.flat ?? IDENTITY;
    const { places } = bodiesEncounter(wall, placed);
    return places.map(([x, y]) => u.map((value, k) => x * value + y * v[k]));
  }
  const places = wall.points.map((i) => placeIn(found[robot.points[i].frame], robot.points[i].at));
  if (wall.kind === "pair") return places;
  const at = wall.body === null ? places[0] : lowestCorner(robot, wall, found).place;
  const margin = (dot(wall.normal, at) - wall.offset) / dot(wall.normal, wall.normal);
  return [at, at.map((value, k) => value - margin * wall.normal[k])];
}

/** @type {(wall: Wall) => number[]} */
function bodiesOf(wall) {
  if (wall.kind === "bodies") return wall.bodies;
  return wall.kind === "half-space" && wall.body !== null ? [wall.body] : [];
}

/** Dots at the two nearest places of bodies that stand out.
 * @type {(marks: SVGCircleElement[], wall: Wall, ends: Point[], lit: Lit) => void} */
function placeNearest(marks, wall, ends, lit) {
  for (const [k, mark] of marks.entries()) {
    mark.toggleAttribute("hidden", !lit.bold.has(wall.name) && lit.closest !== wall.name);
    mark.classList.toggle("lit", lit.violated.has(wall.name));
    if (ends[k]) placeAt(mark, ends[k], "c");
  }
}

/** A dashed line from point to point, or from point to wall, of a boundary that stands out.
 * @type {(line: SVGLineElement, wall: Wall, ends: Point[], lit: Lit) => void} */
function placeGap(line, wall, [a, b], lit) {
  const near = lit.boundaries.has(wall.name);
  line.toggleAttribute("hidden", !near);
  line.classList.toggle("closest", lit.closest === wall.name);
  line.classList.toggle("lit", lit.violated.has(wall.name));
  if (!near) return;
  set(line, { x1: a[0], y1: a[1], x2: b[0], y2: b[1] });
}

/** The arm without bodies at another pose: a line from base to tool.
 * @type {(robot: Robot, drawn: Picture, q: Pose) => string} */
function skeleton(robot, drawn, q) {
  const [found, axes] = [framesOf(robot, q), viewAxes(robot, q)];
  const places = [...found.map((frame) => frame.place), pointPlaces(robot, q)[robot.tool]];
  return pathText(places.map((p) => drawn.at(project(axes, p))));
}
