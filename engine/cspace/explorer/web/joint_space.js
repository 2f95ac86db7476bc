/* The picture of joint space. Like the arm's it is handed the state and changes nothing else. */

/** @type {(svg: SVGSVGElement, robot: Robot, state: State, slice: Slice) => JointPicture} */
function drawJointSpace(svg, robot, state, slice) {
  const ranges = robot.views.map((view) => [view.low, view.high]);
  const line = lineHeight(svg);
  const joint = robot.joints[robot.free[1]];
  const ends = ranges[1].map((value) => wordWidth(svg, shown(joint, value)));
  const left = 14 + line + Math.max(...ends); // a name that is turned, then numbers
  const margin = { left, right: 12, top: 12, bottom: 12 + 2 * line };
  const drawn = picture(svg, ranges, margin, false);
  clear(drawn);
  drawAxes(drawn, jointAxesOf(robot, drawn, line));
  drawCells(drawn, slice);
  if (state.show.sample)
    drawMarks(layer(drawn, "sample"), state.sample, (one) => drawn.at(one.pair));
  const singular = drawSingular(drawn, slice);
  const arcs = drawArcs(drawn, robot, slice);
  if (state.show.polygon && slice.own && robot.polygon)
    drawPolygon(drawn, robot.polygon, state.scale);
  const path = layer(drawn, "joint-path").appendChild(make("path", { class: "path" }));
  const ghost = layer(drawn, "joint-ghost").appendChild(make("circle", { class: "ghost", r: 8 }));
  const hand = handle(svg, make("circle", { class: "handle", r: 8 }));
  return { ...drawn, ...hand, singular, arcs, path, ghost };
}

/** The axes of both free joints, with as many numbers as have room.
 * @type {(robot: Robot, drawn: Picture, line: number) => JointAxis[]} */
function jointAxesOf(robot, drawn, line) {
  const { left, top, right, bottom } = drawn.box;
  return robot.views.map((view, k) => {
    const joint = robot.joints[robot.free[k]];
    const turn = joint.kind === "revolute";
    const ends = [view.low, view.high].map((value) => wordWidth(drawn.svg, shown(joint, value)));
    const most = k === 0 ? (right - left) / (Math.max(...ends) + 8) : (bottom - top) / (line + 4);
    const values = ticks(view, turn, most);
    return {
      name: joint.name,
      unit: turn ? "°" : robot.length_unit,
      ticks: values.map((value) => ({ value, text: shown(joint, value) })),
    };
  });
}

/** Round values to label an axis with, at most so many.
 * @type {(view: View, turn: boolean, most: number) => number[]} */
function ticks(view, turn, most) {
  const span = view.high - view.low;
  const unit = 10 ** Math.floor(Math.log10(span / 3));
  const sizes =
    turn && span > 1
      ? [30, 60, 90, 120, 180, 360].map((size) => (size * Math.PI) / 180)
      : [1, 2, 5, 10, 20, 50].map((k) => k * unit);
  const labels = Math.min(8, most);
  const step = sizes.find((size) => span / size <= labels) ?? span;
  const found = [];
  for (let k = Math.ceil(view.low / step - 1e-9); k * step <= view.high + 1e-9; k += 1)
    found.push(k * step);
  return found;
}

/** A joint value as the page writes it: whole degrees, or a length.
 * @type {(joint: Joint, value: number) => string} */
function shown(joint, value) {
  const number = joint.kind === "revolute" ? (value * 180) / Math.PI : value;
  return String(Number(number.toFixed(joint.kind === "revolute" ? 0 : 2))).replace("-", "−");
}

/** @type {(drawn: Picture, slice: Slice) => void} */
function drawCells(drawn, slice) {
  const group = layer(drawn, "cells");
  const outlines = { home: "", away: "" };
  for (const cell of slice.cells) {
    outlines[cell.piece === slice.home ? "home" : "away"] += pathText(
      outline(cell.rows).map(drawn.at),
      true,
    );
  }
  for (const [name, d] of Object.entries(outlines)) group.append(make("path", { class: name, d }));
}

/** @type {(drawn: Picture, slice: Slice) => SVGLineElement[]} */
function drawSingular(drawn, slice) {
  const group = layer(drawn, "singular-lines");
  const { left, right } = drawn.box;
  const heights = slice.lines.map((value) => drawn.at([0, value])[1]);
  const lines = heights.map((y) =>
    make("line", { class: "singular", x1: left, x2: right, y1: y, y2: y }),
  );
  group.append(...lines);
  if (heights.length > 0) {
    const at = { x: right - 6, y: heights[0] - 6, "text-anchor": "end" };
    group.append(make("text", { class: "line-name", ...at }, "det J = 0"));
  }
  return lines;
}

/** All arcs, again one turn further where a joint turns all the way round.
 * @type {(drawn: Picture, robot: Robot, slice: Slice) => (SVGPathElement | SVGTextElement)[]} */
function drawArcs(drawn, robot, slice) {
  const group = layer(drawn, "arcs");
  const shifts = robot.views.map((view) => (view.wraps && slice.exact ? [-TURN, 0, TURN] : [0]));
  const arcs = slice.arcs.map((arc) => {
    const copies = shifts[0].flatMap((a) =>
      shifts[1].map((b) => pathText(arc.points.map(([x, y]) => drawn.at([x + a, y + b])))),
    );
    const path = make("path", { class: arc.home ? "arc" : "arc of-away", d: copies.join("") });
    return ownColour(robot, path, arc.boundary);
  });
  group.append(...arcs);
  return [...arcs, ...nameArcs(drawn, robot, slice)];
}

/** Write a boundary's name beside the longest of its arcs, outside the home component.
 * @type {(drawn: Picture, robot: Robot, slice: Slice) => SVGTextElement[]} */
function nameArcs(drawn, robot, slice) {
  const arcs = slice.arcs
    .filter((arc) => arc.home)
    .map((arc) => ({ key: `${arc.boundary} ${arc.branch}`, arc, points: arc.points.map(drawn.at) }))
    .map((one) => ({ ...one, size: sum(stepLengths(one.points)) }))
    .filter((one) => one.size > 26)
    .map((one) => ({ ...one, size: Math.round(one.size) })) // of equal arcs the first has the name
    .sort((a, b) => b.size - a.size);
  const longest = arcs.filter((one, i) => arcs.findIndex(({ key }) => key === one.key) === i);
  const group = layer(drawn, "arc-names", false);
  const names = longest.map(({ arc, points }) =>
    ownColour(robot, nameBeside(drawn, arc.boundary, points), arc.boundary),
  );
  group.append(...names);
  thin(names, drawn.width);
  return names;
}

/** @type {(drawn: Picture, name: string, points: Point[]) => SVGTextElement} */
function nameBeside(drawn, name, points) {
  const [[x, y], [nx, ny]] = middleOf(points);
  const half = 4 * name.length; // of the word's width, about
  const { left, top, right, bottom } = drawn.box;
  const at = {
    x: between(x + (half + 7) * nx, left + half, right - half),
    y: between(y + 15 * ny + 4, top + 14, bottom - 5),
  };
  return make("text", { class: "arc-name", ...at, "text-anchor": "middle" }, name);
}

/** @type {(points: Point[]) => number[]} */
function stepLengths(points) {
  return points.slice(1).map((p, i) => Math.hypot(...minus(p, points[i])));
}

/** The middle of a polyline by length, and the unit normal to the right of its direction.
 * @type {(points: Point[]) => Point[]} */
function middleOf(points) {
  const { leg, share } = legAt(stepLengths(points), 0.5);
  const [a, b] = [points[leg], points[leg + 1]];
  const way = minus(b, a);
  const size = Math.hypot(...way) || 1;
  return [partWay(a, b, share), [-way[1] / size, way[0] / size]];
}

/** @type {(drawn: Picture, polygon: VertexPolygon, scale: number) => void} */
function drawPolygon(drawn, { vertices, centroid, largest }, scale) {
  const group = layer(drawn, "scaled");
  const corners = scaledPolygon(vertices, scale, centroid);
  const name = scale > largest ? "polygon unsafe" : "polygon";
  group.append(make("path", { class: name, d: pathText(corners.map(drawn.at), true) }));
  const [gx, gy] = drawn.at(centroid);
  group.append(
    make("path", { class: "centroid", d: `M${gx - 6} ${gy}H${gx + 6}M${gx} ${gy - 6}V${gy + 6}` }),
  );
  const names = corners.map((corner, i) => {
    const [x, y] = drawn.at(corner);
    const [dx, dy] = [gx - x, gy - y];
    const size = Math.hypot(dx, dy) || 1;
    const at = { x: x + (16 * dx) / size, y: y + (16 * dy) / size + 4, "text-anchor": "middle" };
    return make("text", { class: "vertex-name", ...at }, String(i + 1));
  });
  group.append(...names);
  thin(names, drawn.width);
}
