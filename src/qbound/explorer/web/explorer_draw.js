/* What the two pictures of the explorer show. They are handed the state and change nothing else. */

const SVG = "http://www.w3.org/2000/svg";

function make(name, attributes = {}, text = null) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== null) element.textContent = text;
  return element;
}

/** A picture with two scales: `at` leads from values to pixels, `from` back. */
function picture(svg, ranges, margin, equal) {
  const width = Math.max(240, svg.parentElement.clientWidth);
  const height = Math.round(Math.min(width, 560));
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("height", height);
  const [[x0, x1], [y0, y1]] = ranges;
  const [w, h] = [width - margin.left - margin.right, height - margin.top - margin.bottom];
  let [a, b] = [w / (x1 - x0), h / (y1 - y0)];
  if (equal) a = b = Math.min(a, b);
  const left = margin.left + (w - a * (x1 - x0)) / 2;
  const top = margin.top + (h - b * (y1 - y0)) / 2;
  return {
    svg,
    width,
    height,
    box: { left, top, right: left + a * (x1 - x0), bottom: top + b * (y1 - y0) },
    at: ([x, y]) => [left + a * (x - x0), top + b * (y1 - y)],
    from: ([x, y]) => [x0 + (x - left) / a, y1 - (y - top) / b],
  };
}

function pathText(points, closed = false) {
  const text = points.map(([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`).join("L");
  return points.length ? `M${text}${closed ? "Z" : ""}` : "";
}

/** A clipped layer inside a picture's box. */
function layer(drawn, name, clipped = true) {
  const group = make("g", clipped ? { class: name, "clip-path": `url(#${drawn.svg.id}-clip)` } : { class: name });
  drawn.svg.append(group);
  return group;
}

function clear(drawn) {
  drawn.svg.replaceChildren();
  const { left, top, right, bottom } = drawn.box;
  const clip = make("clipPath", { id: `${drawn.svg.id}-clip` });
  clip.append(make("rect", { x: left, y: top, width: right - left, height: bottom - top }));
  drawn.svg.append(clip);
}

/* --- joint space ------------------------------------------------------------------------------- */

function drawJointSpace(robot, state, slice) {
  const svg = document.getElementById("joints");
  const ranges = robot.views.map((view) => [view.low, view.high]);
  const line = lineHeight(svg);
  const drawn = picture(svg, ranges, { left: 46, right: 12, top: 12, bottom: 12 + 2 * line }, false);
  clear(drawn);
  drawJointAxes(robot, drawn, line);
  drawCells(drawn, robot, slice);
  if (state.show.sample) drawMarks(layer(drawn, "sample"), state.sample, (one) => drawn.at(one.pair));
  drawSingular(drawn, slice);
  drawArcs(drawn, robot, slice);
  if (state.show.polygon && slice.exact && robot.polygon) drawPolygon(drawn, robot, state);
  drawn.path = layer(drawn, "joint-path").appendChild(make("path", { class: "path" }));
  drawn.ghost = layer(drawn, "joint-ghost").appendChild(make("circle", { class: "ghost", r: 8 }));
  Object.assign(drawn, handle(svg, make("circle", { class: "handle", r: 8 })));
  return drawn;
}

/** The height of a line of text: it differs from font to font. */
function lineHeight(svg) {
  const probe = svg.appendChild(make("text", {}, "0"));
  const { height } = probe.getBBox();
  probe.remove();
  return height;
}

/** Below the box are two rows, beneath the label that stands at its lowest corner. */
function drawJointAxes(robot, drawn, line) {
  const group = layer(drawn, "axes", false);
  const { left, top, right, bottom } = drawn.box;
  const rows = [bottom + 4 + line, bottom + 4 + 2 * line];
  robot.views.forEach((view, k) => {
    const joint = robot.joints[robot.free[k]];
    const turn = joint.kind === "revolute";
    for (const value of ticks(view, turn)) {
      const [x, y] = drawn.at(k === 0 ? [value, 0] : [0, value]);
      const ends = k === 0 ? { x1: x, x2: x, y1: top, y2: bottom } : { x1: left, x2: right, y1: y, y2: y };
      group.append(make("line", { class: "grid", ...ends }));
      const place = k === 0 ? { x, y: rows[0], "text-anchor": "middle" }
        : { x: left - 6, y: y + 4, "text-anchor": "end" };
      group.append(make("text", place, shown(joint, value, robot)));
    }
    const title = `${joint.name} / ${turn ? "°" : robot.length_unit}`;
    group.append(k === 0
      ? make("text", { x: right, y: rows[1], "text-anchor": "end" }, title)
      : make("text", { x: 4, y: rows[1] }, `↑ ${title}`));
  });
}

/** Round values to label an axis with. */
function ticks(view, turn) {
  const span = view.high - view.low;
  const unit = 10 ** Math.floor(Math.log10(span / 3));
  const step = turn && span > 1 ? Math.PI / (span > 4 ? 3 : 6)
    : [1, 2, 5].map((k) => k * unit).find((size) => span / size <= 8) || 10 * unit;
  const found = [];
  for (let k = Math.ceil(view.low / step - 1e-9); k * step <= view.high + 1e-9; k += 1) found.push(k * step);
  return found;
}

/** A joint value as the page writes it: whole degrees, or a length. */
function shown(joint, value) {
  const number = joint.kind === "revolute" ? (value * 180) / Math.PI : value;
  return String(Number(number.toFixed(joint.kind === "revolute" ? 0 : 2))).replace("-", "−");
}

function drawCells(drawn, robot, slice) {
  const group = layer(drawn, "cells");
  const outlines = { home: "", away: "" };
  for (const cell of slice.cells) {
    outlines[cell.piece === slice.home ? "home" : "away"] += pathText(outline(cell.rows).map(drawn.at), true);
  }
  for (const [name, d] of Object.entries(outlines)) group.append(make("path", { class: name, d }));
}

function drawSingular(drawn, slice) {
  const group = layer(drawn, "singular-lines");
  drawn.singular = slice.lines.map((value) => {
    const [, y] = drawn.at([0, value]);
    const line = make("line", { class: "singular", x1: drawn.box.left, x2: drawn.box.right, y1: y, y2: y });
    group.append(line);
    return line;
  });
  slice.lines.slice(0, 1).forEach((value) => {
    const [, y] = drawn.at([0, value]);
    group.append(make("text", { class: "line-name", x: drawn.box.right - 6, y: y - 6, "text-anchor": "end" }, "det J = 0"));
  });
}

/** All arcs, again one turn further where a joint turns all the way round. */
function drawArcs(drawn, robot, slice) {
  const group = layer(drawn, "arcs");
  const shifts = robot.views.map((view) => (view.wraps && slice.exact ? [-TURN, 0, TURN] : [0]));
  drawn.arcs = [];
  for (const arc of slice.arcs) {
    let d = "";
    for (const a of shifts[0]) {
      for (const b of shifts[1]) d += pathText(arc.points.map(([x, y]) => drawn.at([x + a, y + b])));
    }
    const path = make("path", { class: arc.home ? "arc" : "arc of-away", d });
    path.dataset.boundary = arc.boundary;
    group.append(path);
    drawn.arcs.push(path);
  }
  drawn.arcs.push(...nameArcs(drawn, slice));
}

/** Write a boundary's name beside the longest of its arcs, outside the home component. */
function nameArcs(drawn, slice) {
  const longest = new Map();
  for (const arc of slice.arcs.filter((one) => one.home)) {
    const points = arc.points.map(drawn.at);
    const size = points.slice(1).reduce((sum, p, i) => sum + Math.hypot(p[0] - points[i][0], p[1] - points[i][1]), 0);
    const key = `${arc.boundary} ${arc.branch}`;
    if (size > 26 && (!longest.has(key) || longest.get(key).size < size)) longest.set(key, { arc, points, size });
  }
  const group = layer(drawn, "arc-names", false);
  const names = [...longest.values()].sort((a, b) => b.size - a.size).map(({ arc, points }) => {
    const [[x, y], [nx, ny]] = middleOf(points);
    const half = 4 * arc.boundary.length; // of the word's width, about
    const { left, top, right, bottom } = drawn.box;
    const text = make("text", {
      class: "arc-name",
      x: between(x + (half + 7) * nx, left + half, right - half),
      y: between(y + 15 * ny + 4, top + 14, bottom - 5),
      "text-anchor": "middle",
    }, arc.boundary);
    text.dataset.boundary = arc.boundary;
    group.append(text);
    return text;
  });
  thin(names, drawn.width);
  return names;
}

function between(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

/** The middle of a polyline by length, and the unit normal to the right of its direction. */
function middleOf(points) {
  const steps = points.slice(1).map((p, i) => Math.hypot(p[0] - points[i][0], p[1] - points[i][1]));
  let rest = steps.reduce((sum, step) => sum + step, 0) / 2;
  let i = 0;
  while (i < steps.length - 1 && rest > steps[i]) { rest -= steps[i]; i += 1; }
  const [a, b] = [points[i], points[i + 1]];
  const share = steps[i] === 0 ? 0 : rest / steps[i];
  const [dx, dy] = [(b[0] - a[0]) / (steps[i] || 1), (b[1] - a[1]) / (steps[i] || 1)];
  return [[a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])], [-dy, dx]];
}

function drawPolygon(drawn, robot, state) {
  const { vertices, centroid, largest } = robot.polygon;
  const group = layer(drawn, "scaled");
  const corners = scaledPolygon(vertices, state.scale, centroid);
  const unsafe = state.scale > largest;
  group.append(make("path", { class: unsafe ? "polygon unsafe" : "polygon", d: pathText(corners.map(drawn.at), true) }));
  const [gx, gy] = drawn.at(centroid);
  group.append(make("path", { class: "centroid", d: `M${gx - 6} ${gy}H${gx + 6}M${gx} ${gy - 6}V${gy + 6}` }));
  corners.forEach((corner, i) => {
    const [x, y] = drawn.at(corner);
    const [dx, dy] = [gx - x, gy - y];
    const size = Math.hypot(dx, dy) || 1;
    group.append(make("text", { class: "vertex-name", x: x + (16 * dx) / size, y: y + (16 * dy) / size + 4, "text-anchor": "middle" }, i + 1));
  });
}

/** Random poses: round dots where safe, crosses where not. */
function drawMarks(group, sample, place) {
  const d = { dots: "", crosses: "" };
  for (const one of sample) {
    const [x, y] = place(one).map((value) => Number(value.toFixed(1)));
    if (one.safe) d.dots += `M${x} ${y}h0`;
    else d.crosses += `M${x - 2} ${y - 2}l4 4m0 -4l-4 4`;
  }
  for (const [name, text] of Object.entries(d)) group.append(make("path", { class: name, d: text }));
}

/** A handle to drag, with room around it for a finger. */
function handle(svg, mark) {
  const group = make("g", { class: "handle-group" });
  const room = make("circle", { class: "reach-me", r: 24 });
  group.append(mark, room);
  svg.append(group);
  return { group, mark, room };
}

/* --- the arm ----------------------------------------------------------------------------------- */

/** The part of the plane that the arm can reach, its bodies included, whatever joint moves. */
function planeBox(robot) {
  const [xs, ys] = [[0], [0]];
  const note = ([x, y]) => { xs.push(x); ys.push(y); };
  const steps = Array.from({ length: 17 }, (_, i) => i / 16);
  for (const q of posesOfHeld(robot)) {
    for (const a of steps) {
      for (const b of steps) {
        const pair = robot.views.map((v, k) => v.low + (k ? b : a) * (v.high - v.low));
        planePlaces(robot, withPair(robot, q, pair)).forEach(note);
      }
    }
  }
  const pad = 0.04 * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
  return [[Math.min(...xs) - pad, Math.max(...xs) + pad], [Math.min(...ys) - pad, Math.max(...ys) + pad]];
}

/** The pose that the page opens with, and each held joint on its own at places of its range. */
function posesOfHeld(robot) {
  const others = robot.joints.flatMap((joint, j) => {
    if (robot.free.includes(j)) return [];
    const [low, high] = joint.limits || [-Math.PI, Math.PI];
    return [0, 0.25, 0.5, 0.75, 1].map((s) => robot.q.map((value, i) => (i === j ? low + s * (high - low) : value)));
  });
  return [robot.q, ...others];
}

/** Everything of the arm that takes room in the plane. */
function planePlaces(robot, q) {
  const [found, axes] = [frames(robot, q), viewAxes(robot, q)];
  const corners = robot.bodies.flatMap((body) => body.outline.map((p) => placeIn(found[body.frame], p)));
  const points = robot.points.map((point) => placeIn(found[point.frame], point.at));
  return [...corners, ...points, ...found.map((frame) => frame.place)].map((p) => project(axes, p));
}

function withPair(robot, q, pair) {
  const pose = [...q];
  robot.free.forEach((j, k) => { pose[j] = pair[k]; });
  return pose;
}

function drawPlane(robot, state, slice, box) {
  const svg = document.getElementById("plane");
  const drawn = picture(svg, box, { left: 8, right: 8, top: 8, bottom: 26 }, true);
  drawn.box = { left: 0, top: 0, right: drawn.width, bottom: drawn.height };
  clear(drawn);
  drawScaleBar(robot, drawn);
  if (state.show.workspace) drawWorkspace(drawn, slice);
  drawWalls(robot, drawn, state);
  if (state.show.sample) drawMarks(layer(drawn, "sample"), state.sample, (one) => drawn.at(one.tool));
  drawn.path = layer(drawn, "tool-path").appendChild(make("path", { class: "path" }));
  drawn.ghost = layer(drawn, "arm-ghost").appendChild(make("path", { class: "ghost" }));
  addArm(robot, drawn);
  Object.assign(drawn, handle(svg, make("rect", { class: "handle", x: -7, y: -7, width: 14, height: 14, rx: 2 })));
  return drawn;
}

function drawScaleBar(robot, drawn) {
  const group = layer(drawn, "axes", false);
  const [left] = drawn.from([0, 0]);
  const [right] = drawn.from([drawn.width, 0]);
  const unit = 10 ** Math.floor(Math.log10((right - left) / 4));
  const length = [5, 2, 1].map((k) => k * unit).find((size) => size <= (right - left) / 4);
  const pixels = drawn.at([length, 0])[0] - drawn.at([0, 0])[0];
  const y = drawn.height - 10;
  group.append(make("path", { class: "wall", d: `M12 ${y - 4}v8M12 ${y}h${pixels}m0 -4v8` }));
  group.append(make("text", { x: 20 + pixels, y: y + 4 }, `${Number(length.toPrecision(2))} ${robot.length_unit}`));
}

function drawWorkspace(drawn, slice) {
  const group = layer(drawn, "images");
  for (const image of Object.values(slice.images)) {
    const d = image.map((points) => pathText(points.map(drawn.at), true)).join("");
    group.append(make("path", { class: "workspace", d }));
  }
}

/** Walls of the plane: the line, and a tint of what lies beyond it. */
function drawWalls(robot, drawn, state) {
  const group = layer(drawn, "walls");
  const corners = [[0, 0], [drawn.width, 0], [drawn.width, drawn.height], [0, drawn.height]].map(drawn.from);
  const places = pointPlaces(robot, state.q);
  const axes = viewAxes(robot, state.q);
  drawn.walls = robot.boundaries.filter((wall) => wall.kind === "half-space").map((wall) => {
    const normal = project(axes, wall.normal);
    const offset = wall.offset - dot(axes[2], wall.normal) * dot(axes[2], places[wall.points[0]]);
    const side = ([x, y]) => normal[0] * x + normal[1] * y - offset;
    if (wall.used) group.append(make("path", { class: "beyond", d: pathText(clipBelow(corners, side).map(drawn.at), true) }));
    const ends = lineThrough(corners, side).map(drawn.at);
    const line = make("path", { class: wall.used ? "wall" : "wall unused", d: pathText(ends) });
    line.dataset.boundary = wall.name;
    group.append(line);
    if (ends.length === 2) group.append(wallLabel(wall, ends, drawn));
    return line;
  });
  thin(group.querySelectorAll("text"), drawn.width);
}

/** Keep names inside the picture, and leave out one that would cover another. */
function thin(names, width) {
  const kept = [];
  for (const name of names) {
    const { x, width: size } = name.getBBox();
    name.setAttribute("x", Number(name.getAttribute("x")) + Math.max(0, 4 - x) - Math.max(0, x + size + 4 - width));
    const box = name.getBBox();
    const covers = (other) => Math.abs(box.x + box.width / 2 - other.x - other.width / 2) < (box.width + other.width) / 2
      && Math.abs(box.y - other.y) < box.height - 2;
    if (kept.some(covers)) name.remove();
    else kept.push(box);
  }
}

/** Write a wall's name where its line leaves the picture on the right, or at the top. */
function wallLabel(wall, ends, drawn) {
  const [x, y] = ends.reduce((best, one) => (one[0] - one[1] > best[0] - best[1] ? one : best));
  const at = { x: Math.min(drawn.width - 8, x - 6), y: Math.max(16, y - 6), "text-anchor": "end" };
  return make("text", { class: "wall-name", ...at }, wall.name);
}

/** The part of a polygon where `side` is negative (Sutherland and Hodgman). */
function clipBelow(corners, side) {
  return corners.flatMap((a, i) => {
    const b = corners[(i + 1) % corners.length];
    const kept = side(a) <= 0 ? [a] : [];
    return (side(a) <= 0) === (side(b) <= 0) ? kept : [...kept, crossing(a, b, side)];
  });
}

function lineThrough(corners, side) {
  return corners.flatMap((a, i) => {
    const b = corners[(i + 1) % corners.length];
    return (side(a) <= 0) === (side(b) <= 0) ? [] : [crossing(a, b, side)];
  });
}

function crossing(a, b, side) {
  const share = side(a) / (side(a) - side(b));
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}

/** The elements that move with the pose; `placeArm` moves them. */
function addArm(robot, drawn) {
  const group = layer(drawn, "arm");
  drawn.bodies = robot.bodies.map((body) => group.appendChild(
    make("polygon", { class: "body", fill: `var(--links-${body.frame % 5})` })));
  drawn.spine = group.appendChild(make("path", { class: "spine" }));
  drawn.axles = robot.joints.map(() => group.appendChild(make("circle", { class: "axle", r: 5 })));
  drawn.gaps = robot.boundaries.map((wall) => group.appendChild(
    make("line", { class: "gap", hidden: wall.kind === "pair" ? null : "" })));
  drawn.points = robot.points.map((point) => group.appendChild(
    make("circle", { class: point.radius > 0 ? "sphere" : "point", r: 3 })));
  drawn.names = robot.points.map((point) => group.appendChild(
    make("text", { class: "point-name" }, point.name)));
}

/** Move the arm to a pose; `lit` are the points and boundaries that stand out. */
function placeArm(robot, drawn, state, lit) {
  const [found, axes] = [frames(robot, state.q), viewAxes(robot, state.q)];
  const at = (place) => drawn.at(project(axes, place));
  robot.bodies.forEach((body, i) => drawn.bodies[i].setAttribute(
    "points", body.outline.map((p) => at(placeIn(found[body.frame], p)).join(",")).join(" ")));
  const places = robot.points.map((point) => at(placeIn(found[point.frame], point.at)));
  const spine = [...found.map((frame) => at(frame.place)), places[robot.tool]];
  drawn.spine.setAttribute("d", pathText(spine));
  drawn.axles.forEach((axle, j) => moveTo(axle, spine[j + 1], "c"));
  drawn.points.forEach((mark, i) => placePoint(robot, drawn, state, lit, i, places[i]));
  robot.boundaries.forEach((wall, i) => placeGap(drawn.gaps[i], wall, places, lit));
  drawn.group.setAttribute("transform", `translate(${places[robot.tool].join(" ")})`);
}

function moveTo(element, [x, y], prefix = "") {
  element.setAttribute(`${prefix}x`, x);
  element.setAttribute(`${prefix}y`, y);
}

function placePoint(robot, drawn, state, lit, i, [x, y]) {
  const [mark, name, point] = [drawn.points[i], drawn.names[i], robot.points[i]];
  const size = drawn.at([point.radius, 0])[0] - drawn.at([0, 0])[0];
  moveTo(mark, [x, y], "c");
  mark.setAttribute("r", point.radius > 0 ? size : 3);
  mark.classList.toggle("lit", lit.points.has(i));
  name.classList.toggle("lit", lit.points.has(i));
  name.toggleAttribute("hidden", !state.show.names && !lit.points.has(i));
  const left = i % 2 === 0; // two points of a pair in contact lie at one place
  name.setAttribute("text-anchor", left ? "end" : "start");
  moveTo(name, [x + (left ? -7 : 7), y + (left ? 13 : -6)]);
}

/** A dashed line between the points of a pair that stands out. */
function placeGap(line, wall, places, lit) {
  const near = wall.kind === "pair" && lit.boundaries.has(wall.name);
  line.toggleAttribute("hidden", !near);
  if (!near) return;
  const [a, b] = wall.points.map((i) => places[i]);
  for (const [key, value] of Object.entries({ x1: a[0], y1: a[1], x2: b[0], y2: b[1] })) line.setAttribute(key, value);
  line.classList.toggle("lit", lit.violated.has(wall.name));
}

/** The arm without bodies at another pose: a line from base to tool. */
function skeleton(robot, drawn, q) {
  const [found, axes] = [frames(robot, q), viewAxes(robot, q)];
  const places = [...found.map((frame) => frame.place), pointPlaces(robot, q)[robot.tool]];
  return pathText(places.map((p) => drawn.at(project(axes, p))));
}
