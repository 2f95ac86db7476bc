"use strict";
/* What the page "Configuration space, live" computes for one step of a drag: two links and ten
   obstacles, a thousand columns; medians of processor time, by Node. It follows the engine and
   book/_static/play/live_space.js; README.md has the command. */
{
  const { process } = /** @type {any} */ (globalThis);
  const COLUMNS = 1000;
  const SCALE = { x0: 300, dx: 90, y0: 300, dy: -90 };
  const CORNERS = [
    [0.15, 0],
    [0.05, 0.14],
    [-0.12, 0.09],
    [-0.12, -0.09],
    [0.05, -0.14],
  ];

  /** Obstacles of three kinds on a spiral within reach.
   * @type {(count: number) => LiveObstacle[]} */
  function obstacles(count) {
    return Array.from({ length: count }, (_, i) => {
      const [far, way] = [0.75 + (1.1 * i) / count, 2.4 * i];
      const place = { name: "", x: far * Math.cos(way), y: far * Math.sin(way), angle: i };
      if (i % 3 === 0) return { kind: "disc", ...place, sizes: [0.1], corners: [] };
      if (i % 3 === 1) return { kind: "box", ...place, sizes: [0.3, 0.2], corners: [] };
      return { kind: "polygon", ...place, sizes: [], corners: CORNERS };
    });
  }

  /** All that a step computes: columns, pieces, what is drawn.
   * @type {(space: LiveSpace, arm: LiveArm, shapes: LiveShape[]) => void} */
  function update(space, arm, shapes) {
    const columns = space.columnsOf(arm, shapes);
    const regions = qboundLiveSpace.regions(columns, [0, 0]);
    qboundLiveSpace.outlines(columns, regions.of, regions.areas.length, SCALE);
  }

  /** Milliseconds of processor time of a step: the median of many.
   * @type {(step: (k: number) => void, times: number) => string} */
  function cost(step, times) {
    const all = [];
    for (let k = 0; k < times; k += 1) {
      const { user } = process.cpuUsage();
      step(k);
      all.push((process.cpuUsage().user - user) / 1000);
    }
    return all.sort((a, b) => a - b)[times >> 1].toFixed(1);
  }

  console.log("| obstacles | one dragged / ms | a link made longer / ms | the arm alone / ms |");
  console.log("| --- | --- | --- | --- |");
  for (const count of [3, 10, 30]) {
    const arm = { lengths: [1, 0.8], radii: [0.06, 0.05] };
    const all = obstacles(count);
    let shapes = all.map(qboundLiveSpace.placed);
    const space = qboundLiveSpace.freeSpace(COLUMNS);
    update(space, arm, shapes);
    const dragged = (/** @type {number} */ k) => {
      const moved = qboundLiveSpace.placed({ ...all[1], x: all[1].x + 0.001 * (k % 300) });
      shapes = shapes.map((shape, i) => (i === 1 ? moved : shape));
      update(space, arm, shapes);
    };
    const longer = (/** @type {number} */ k) =>
      update(space, { ...arm, lengths: [1, 0.8 - 0.001 * (k % 300)] }, shapes);
    const turned = (/** @type {number} */ k) =>
      qboundLiveSpace.encounters(arm, shapes, [0.01 * k, 0.02 * k]);
    const costs = [cost(dragged, 300), cost(longer, 100), cost(turned, 300)];
    console.log(`| ${[count, ...costs].join(" | ")} |`);
  }
}
