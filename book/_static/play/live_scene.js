"use strict";
/* Configuration space, live: an arm among obstacles, as a link keeps it and as a robot file says it.
   Lengths are in metres, angles in radians; links and files have degrees. */
const qboundLiveScene = (() => {
  const { between, wrapped } = qboundEngine;
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
      { kind: "disc", name: "pillar", x: 1.15, y: -0.4, angle: 0, radius: 0.2 },
      { kind: "box", name: "crate", x: 0.7, y: 0.8, angle: 0.3, width: 0.5, height: 0.35 },
      {
        kind: "polygon",
        name: "wedge",
        x: -0.55,
        y: -1.05,
        angle: 0,
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
      const disc = placed({ kind: "disc", name: "", x, y, angle: 0, radius: 0 });
      const links = [scene.q, scene.home].flatMap((q) => encounters(arm, [disc], q));
      const others = scene.obstacles.map((one) => Math.hypot(one.x - x, one.y - y) - 0.2);
      return Math.min(...links.map(({ gap }) => gap), ...others);
    };
    const places = Array.from({ length: 24 }, (_, k) => {
      const [x, y] = [Math.cos, Math.sin].map((f) => (1.1 + 0.2 * (k % 3)) * f((k * Math.PI) / 12));
      return { x, y, room: room(x, y) };
    });
    const { x, y } = places.reduce((one, other) => (other.room > one.room ? other : one));
    const base = { name: freeName(scene, kind, -1), x, y, angle: 0 };
    if (kind === "disc") return { kind, ...base, radius: 0.15 };
    if (kind === "box") return { kind, ...base, width: 0.4, height: 0.25 };
    const corners = [0, 1, 2, 3, 4].map((k) => {
      const angle = Math.PI / 2 + (2 * Math.PI * k) / 5;
      return [0.22 * Math.cos(angle), 0.22 * Math.sin(angle)];
    });
    return { kind, ...base, corners };
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
    const [x, y] = [within(obstacle.x, RANGES.place), within(obstacle.y, RANGES.place)];
    const found = { ...obstacle, x, y, angle: wrapped(obstacle.angle) };
    if (found.kind === "disc") found.radius = within(found.radius, RANGES.size);
    if (found.kind === "box") {
      found.width = within(found.width, RANGES.size);
      found.height = within(found.height, RANGES.size);
    }
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
      const sizes =
        one.kind === "disc"
          ? [one.radius]
          : one.kind === "box"
            ? [one.width, one.height]
            : one.corners.flat();
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
    const [kind, numbers, ...name] = text.split(" ");
    const count = (numbers ?? "").split(",").length;
    const values = numbersOf(numbers, count);
    if (!values) return null;
    const [x, y, degrees, ...sizes] = values;
    const base = {
      name: freeName(scene, name.join(" "), -1),
      x,
      y,
      angle: wrapped(degrees * DEGREE),
    };
    if (kind === "disc" && sizes.length === 1) return checked({ kind, ...base, radius: sizes[0] });
    if (kind === "box" && sizes.length === 2)
      return checked({ kind, ...base, width: sizes[0], height: sizes[1] });
    if (kind !== "polygon" || sizes.length % 2 === 1) return null;
    const corners = Array.from({ length: sizes.length / 2 }, (_, i) =>
      sizes.slice(2 * i, 2 * i + 2),
    );
    return checked({ kind, ...base, corners });
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
      const { x, y, name } = obstacle;
      lines.push("", "[[obstacle]]", `name = ${JSON.stringify(name)}`);
      if (obstacle.kind === "disc")
        lines.push(`disc = { at = ${row([x, y, 0])}, radius = ${decimal(obstacle.radius)} }`);
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
