"use strict";
/* Configuration space, live: an arm among obstacles, as a link keeps it and as a robot file says it.
   Lengths are in metres, angles in radians; links and files have degrees. */
const qboundLiveScene = (() => {
  const { TURN, between, leastBy, turnedBy, wrapped } = qboundEngine;
  const { encounters, isSimple, placed } = qboundLiveSpace;
  const DEGREE = Math.PI / 180;
  const LINKS = ["upper arm", "forearm"];

  /** Least and most of every number that a reader sets. */
  const RANGES = {
    length: [0.2, 1],
    thickness: [0.02, 0.3],
    place: [-2, 2],
    angle: [-180, 180],
    size: [0.02, 1.5],
    corner: [-1.5, 1.5],
  };
  /** What the sizes of each kind of obstacle are; a polygon has corners instead. */
  const SIZES = { disc: ["radius"], box: ["width", "height"], polygon: [] };
  const KINDS = /** @type {LiveObstacle["kind"][]} */ (Object.keys(SIZES));
  const MOST_OBSTACLES = 30;
  const MOST_CORNERS = 12;
  const LONGEST_NAME = 40;

  /** @type {LiveScene} */
  const START = {
    lengths: [1, 0.8],
    thicknesses: [0.12, 0.1],
    q: [150 * DEGREE, -60 * DEGREE],
    home: [150 * DEGREE, -60 * DEGREE],
    obstacles: [
      { kind: "disc", name: "pillar", x: 1.15, y: -0.4, angle: 0, sizes: [0.2], corners: [] },
      { kind: "box", name: "crate", x: 0.7, y: 0.8, angle: 0.3, sizes: [0.5, 0.35], corners: [] },
      {
        kind: "polygon",
        name: "wedge",
        x: -0.55,
        y: -1.05,
        angle: 0,
        sizes: [],
        corners: [
          [-0.3, -0.2],
          [0.35, -0.2],
          [-0.1, 0.3],
        ],
      },
    ],
  };

  /** @type {(scene: LiveScene) => LiveArm} */
  function armOf({ lengths, thicknesses }) {
    return { lengths, radii: thicknesses.map((value) => value / 2) };
  }

  /** A new obstacle, with a name that none has, away from the arm and the others.
   * @type {(scene: LiveScene, kind: LiveObstacle["kind"]) => LiveObstacle} */
  function newObstacle(scene, kind) {
    const arm = armOf(scene);
    /** @type {(x: number, y: number) => number} */
    const room = (x, y) => {
      const disc = { points: [[x, y]], radius: 0, x, y, size: 0 };
      const links = [scene.q, scene.home].flatMap((q) => encounters(arm, [disc], q));
      const others = scene.obstacles.map((one) => Math.hypot(one.x - x, one.y - y) - 0.2);
      return Math.min(...links.map(({ gap }) => gap), ...others);
    };
    const places = Array.from({ length: 24 }, (_, k) =>
      turnedBy((TURN * k) / 24).map((value) => (1.1 + 0.2 * (k % 3)) * value),
    );
    const [x, y] = leastBy(places, (place) => -room(place[0], place[1])) ?? [0, 0];
    const pentagon = [0, 1, 2, 3, 4].map((k) =>
      turnedBy(TURN / 4 + (TURN * k) / 5).map((value) => 0.22 * value),
    );
    return {
      kind,
      name: freeName(scene, kind, -1),
      x,
      y,
      angle: 0,
      sizes: { disc: [0.15], box: [0.4, 0.25], polygon: [] }[kind],
      corners: kind === "polygon" ? pentagon : [],
    };
  }

  /** A name as a robot file allows it, that no link and no other obstacle has.
   * @type {(scene: LiveScene, wanted: string, index: number) => string} */
  function freeName(scene, wanted, index) {
    const plain = wanted
      .replace(/[^\p{L}\p{N} ._-]/gu, "")
      .trim()
      .slice(0, LONGEST_NAME)
      .trim();
    const taken = scene.obstacles.flatMap(({ name }, i) => (i === index ? [] : [name]));
    const all = new Set([...LINKS, ...taken]);
    const name = plain || "obstacle";
    if (!all.has(name)) return name;
    let k = 2;
    while (all.has(`${name} ${k}`)) k += 1;
    return `${name} ${k}`;
  }

  /** @type {(value: number, range: number[]) => number} */
  function within(value, [low, high]) {
    return between(value, low, high);
  }

  /** An obstacle with its numbers in range; null where it is none (edges that cross).
   * @type {(obstacle: LiveObstacle) => LiveObstacle | null} */
  function checked(obstacle) {
    const [x, y] = [obstacle.x, obstacle.y].map((value) => within(value, RANGES.place));
    const sizes = obstacle.sizes.map((value) => within(value, RANGES.size));
    const found = { ...obstacle, x, y, angle: wrapped(obstacle.angle), sizes };
    if (found.kind !== "polygon") return found;
    const outside = found.corners.flat().some((value) => Math.abs(value) > RANGES.corner[1]);
    const count = found.corners.length;
    if (outside || count < 3 || count > MOST_CORNERS || !isSimple(found.corners)) return null;
    return found;
  }

  /* --- a link ----------------------------------------------------------------------------------- */

  /** @type {(values: number[], digits: number) => string} */
  function list(values, digits) {
    return values.map((value) => Number(value.toFixed(digits)) + 0).join(",");
  }

  /** @type {(pair: Pair) => string} */
  function angles(pair) {
    return list(
      pair.map((value) => value / DEGREE),
      2,
    );
  }

  /** What a link says after its `#`; without the pose, what undoing goes back to.
   * @type {(scene: LiveScene, pose?: boolean) => string} */
  function textOf(scene, pose = true) {
    const words = new URLSearchParams();
    words.set("arm", list([...scene.lengths, ...scene.thicknesses], 4));
    words.set("home", angles(scene.home));
    if (pose) words.set("q", angles(scene.q));
    for (const one of scene.obstacles) {
      const sizes = [...one.sizes, ...one.corners.flat()];
      const numbers = [list([one.x, one.y], 4), list([one.angle / DEGREE], 2), list(sizes, 4)];
      words.append("o", `${one.kind} ${numbers.join(",")} ${one.name}`);
    }
    return words.toString().replaceAll("%2C", ",");
  }

  /** A scene from a link; null where it is not one. What is no obstacle is left out.
   * @type {(text: string) => LiveScene | null} */
  function sceneOf(text) {
    const words = new URLSearchParams(text);
    const arm = numbersOf(words.get("arm"), 4);
    const home = numbersOf(words.get("home"), 2);
    if (!arm || !home) return null;
    const q = numbersOf(words.get("q"), 2) ?? home;
    /** @type {LiveScene} */
    const scene = {
      lengths: arm.slice(0, 2).map((value) => within(value, RANGES.length)),
      thicknesses: arm.slice(2).map((value) => within(value, RANGES.thickness)),
      home: home.map((value) => wrapped(value * DEGREE)),
      q: q.map((value) => wrapped(value * DEGREE)),
      obstacles: [],
    };
    for (const word of words.getAll("o").slice(0, MOST_OBSTACLES)) {
      const found = obstacleOf(word, scene);
      if (found) scene.obstacles.push(found);
    }
    return scene;
  }

  /** @type {(text: string | null, count: number) => number[] | null} */
  function numbersOf(text, count) {
    const found = (text || "none")
      .split(",")
      .map((word) => (word.trim() ? Number(word) : Number.NaN));
    return found.length === count && found.every(Number.isFinite) ? found : null;
  }

  /** @type {(text: string, scene: LiveScene) => LiveObstacle | null} */
  function obstacleOf(text, scene) {
    const [word, numbers, ...name] = text.split(" ");
    const count = (numbers ?? "").split(",").length;
    const values = numbersOf(numbers, count);
    if (!values) return null;
    const [x, y, degrees, ...sizes] = values;
    const kind = KINDS.find((one) => one === word);
    if (!kind) return null;
    const isPolygon = kind === "polygon";
    if (isPolygon ? sizes.length % 2 : sizes.length !== SIZES[kind].length) return null;
    return checked({
      kind,
      name: freeName(scene, name.join(" "), -1),
      x,
      y,
      angle: wrapped(degrees * DEGREE),
      sizes: isPolygon ? [] : sizes,
      corners: isPolygon ? sizes.flatMap((a, i) => (i % 2 ? [[sizes[i - 1], a]] : [])) : [],
    });
  }

  /* --- a robot file ------------------------------------------------------------------------------ */

  /** @type {(value: number) => string} */
  function decimal(value) {
    const text = String(Number(value.toFixed(6)) + 0);
    return text.includes(".") || text.includes("e") ? text : `${text}.0`;
  }

  /** @type {(values: number[]) => string} */
  function row(values) {
    return `[${values.map(decimal).join(", ")}]`;
  }

  /** The arm and its obstacles as a robot file in TOML.
   * @type {(scene: LiveScene) => string} */
  function robotFile(scene) {
    const [first, second] = scene.lengths;
    const [q1, q2] = scene.home.map((value) => decimal(value / DEGREE));
    const lines = [
      '# Written by the page "Configuration space, live".',
      "schema = 1",
      'name = "two links among obstacles"',
      'length_unit = "m"',
      'angle_unit = "deg"',
      `home = { q1 = ${q1}, q2 = ${q2} }`,
      'tool = "tip"',
      'collisions = "all"',
      `allowed = [${JSON.stringify(LINKS)}]`,
      ...joint("q1", "0", "1", 0),
      ...joint("q2", "1", "2", first),
      "",
      "[[point]]",
      'name = "tip"',
      'frame = "2"',
      `at = ${row([second, 0, 0])}`,
    ];
    for (const [k, name] of LINKS.entries()) {
      const [to, radius] = [row([scene.lengths[k], 0, 0]), decimal(scene.thicknesses[k] / 2)];
      lines.push("", "[[body]]", `name = ${JSON.stringify(name)}`, `frame = "${k + 1}"`);
      lines.push(`capsule = { from = [0.0, 0.0, 0.0], to = ${to}, radius = ${radius} }`);
    }
    for (const obstacle of scene.obstacles) {
      const { x, y, name, sizes } = obstacle;
      lines.push("", "[[obstacle]]", `name = ${JSON.stringify(name)}`);
      if (obstacle.kind === "disc")
        lines.push(`disc = { at = ${row([x, y, 0])}, radius = ${decimal(sizes[0])} }`);
      else lines.push(`polygon = [${placed(obstacle).points.map(row).join(", ")}]`);
    }
    return `${lines.join("\n")}\n`;
  }

  /** @type {(name: string, parent: string, frame: string, at: number) => string[]} */
  function joint(name, parent, frame, at) {
    const ends = [`origin = ${row([at, 0, 0])}`, "axis = [0.0, 0.0, 1.0]"];
    const words = Object.entries({ name, type: "revolute", parent, frame });
    return ["", "[[joint]]", ...words.map(([key, value]) => `${key} = "${value}"`), ...ends];
  }

  return {
    DEGREE,
    LINKS,
    RANGES,
    SIZES,
    MOST_OBSTACLES,
    MOST_CORNERS,
    LONGEST_NAME,
    START,
    armOf,
    checked,
    freeName,
    newObstacle,
    robotFile,
    sceneOf,
    textOf,
  };
})();
