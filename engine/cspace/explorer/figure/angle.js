/* Which angle is q2? Three angles of the second link: from where the first link carries it, from the
   picture's horizontal, and between the links. The angle to the horizontal changes with the other joint too. */

KINDS.angle = (robot, _options, figure) => {
  const plane = armScale(robot);
  const view = armView({ only: "-" }, figure, plane);
  figure.set({ q: robot.home.map((value, k) => value + [15, -55][k] * DEGREE), by: null });

  /** An arc about the elbow, in the direction of the shorter way or as far as `by` says. */
  const arc = (centre, from, by, radius) =>
    line(
      Array.from({ length: 33 }, (_, i) => {
        const away = polar(radius * robot.reach, from + (by * i) / 32);
        return plane.at(centre.map((value, k) => value + away[k]));
      }),
    );
  const ray = (centre, angle, length) =>
    line([centre, centre.map((v, k) => v + polar(length * robot.reach, angle)[k])].map(plane.at));

  return (state) => {
    const shown = view(state, robot);
    const arm = shown.pictures[1];
    const { q, lit } = state;
    const [elbow, tip] = [robot.elbow, robot.tool].map((place) => placeAt(robot, place, q));
    const toolAt = (second) => placeAt(robot, robot.tool, [q[0], second]);
    const carried = angleOf(elbow, toolAt(0));
    const now = angleOf(elbow, tip);
    const sense = Math.sign(Math.sin(angleOf(elbow, toolAt(1e-3)) - carried));
    const back = angleOf(elbow, framesAt(robot, q)[1]([0, 0, 0]));
    const rows = [
      ["turned", "q₂: from where link 1 carries link 2", carried, wrap(q[1]), sense * wrap(q[1])],
      ["level", "from the horizontal", 0, wrap(now), wrap(now)],
      ["between", "between the links", back, Math.abs(wrap(now - back)), wrap(now - back)],
    ];
    arm.layers.push({
      content: svg`<path class="wall" d=${ray(elbow, carried, 0.42)} /><path class="thin-line" d=${ray(elbow, 0, 0.42)} />
        ${rows.map(([name, , from, , by], k) => svg`<path class="wide ${name} ${lit === name ? "lit" : ""}" d=${arc(elbow, from, by, 0.16 + 0.09 * k)} />`)}`,
    });
    return {
      controls: shown.controls.slice(0, 2),
      status: [
        `q₂ is ${degrees(wrap(q[1]))}. Move the elbow alone: the angle from the horizontal changes, q₂ does not.`,
        false,
      ],
      pictures: [arm],
      after: html`<table><tbody>${rows.map(
        ([name, text, , value]) =>
          html`<tr class=${lit === name ? "lit" : ""}><th scope="row"><svg class="key" viewBox="0 0 22 8"><path class="wide ${name}" d="M4 4H18"/></svg>${text}</th><td>${degrees(value)}</td></tr>`,
      )}</tbody></table>`,
    };
  };
};
