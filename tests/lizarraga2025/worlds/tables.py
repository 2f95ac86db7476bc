"""Worlds in which the entries of ``statements/tables.toml`` come to other verdicts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from lizarraga2025 import printed as paper
from support.worlds import World, robot_file, with_boundaries, with_points, world


def offset(label: str, **changes: Any) -> World:
    """Return the world in which one offset is printed otherwise."""
    changed = (replace(o, **changes) if o.label == label else o for o in paper.OFFSETS)
    return world(printed={"OFFSETS": tuple(changed)})


def row_of_table_2(number: int, old: str, new: str) -> World:
    """Return the world in which a row of Table 2 has other words."""
    rows = [list(row) for row in paper.TABLE_2]
    rows[number - 1] = [cell.replace(old, new) for cell in rows[number - 1]]
    assert rows != [list(row) for row in paper.TABLE_2]
    return world(printed={"TABLE_2": rows})


def component(label: str) -> World:
    """Return the world in which the last sign of a component of eq. (29) is the other one."""
    start, sign, end = paper.EQUATION_29[label].rpartition(" + ")
    if not sign or " - " in end:
        start, sign, end = paper.EQUATION_29[label].rpartition(" - ")
    other = " + " if sign == " - " else " - "
    return world(printed={"EQUATION_29": {label: start + other + end}})


def bound(row: str, old: str, new: str, *, k: tuple[int, ...] = (1, 2)) -> World:
    """Return the world in which the bounds of a row of Table 6 are printed otherwise."""
    labels = [f"beta_{{{row},{number}}}" for number in k]
    changed = {label: paper.TABLE_6[label].replace(old, new) for label in labels}
    assert all(changed[label] != paper.TABLE_6[label] for label in labels)
    return world(printed={"TABLE_6": changed})


def moved(**places: tuple[float, float, float]) -> World:
    """Return the world of a robot with a point elsewhere."""
    return world(robots={"minervabot-v2": with_points(robot_file(), **places)})


one_elsewhere = {"S_x": ((0, 1, 0), (0, 0, 0), (0, 0, 0))}

WORLDS: dict[str, World] = {
    "T-1": world(printed={"TABLE_1": (*paper.TABLE_1[:3], ("2", "3", "Offset y", "y_{2,3}"))}),
    "T-1.1": offset("z_{0,1}", value=22.0),
    "T-1.2": offset("z_{1,2}", value=25.89),
    "T-1.3": offset("x_{1,2}", value=15.5),
    "T-1.4": offset("x_{2,3}", value=24.0),
    "T-2": row_of_table_2(6, "+", "-"),
    "T-2.1": row_of_table_2(1, "[0", "[z_{0,1}"),
    "T-2.2": row_of_table_2(2, r"[0\ 0\ z_{0,1}]", r"[z_{0,1}\ 0\ 0]"),
    "T-2.3": row_of_table_2(3, "q_2", "q_1"),
    "T-2.4": row_of_table_2(4, "I", "R_y(q_2)"),
    "T-2.5": row_of_table_2(5, "+", "-"),
    "T-2.6": row_of_table_2(6, "+", "-"),
    "T-3": component("beta_{2,1}"),
    "T-3.1": moved(p7=(11.5, 0.0, 4.19)),
    "T-3.2": moved(p9=(-1.5, 0.0, 12.14)),
    "T-3.3": moved(p11=(9.90, 0.0, -5.25)),
    "T-3.4": component("beta_{1,1}"),
    "T-3.5": component("beta_{2,3}"),
    "T-3.6": component("beta_{3,1}"),
    "T-4": component("beta_{4,1}"),
    "T-4.1": moved(p12=(150.0, 0.0, 259.0)),  # ten times as far, so that millimetres reach
    "T-4.2": moved(p13=(9.09, 0.0, 5.25)),
    "T-4.3": component("beta_{4,3}"),
    "T-5": world(printed={"SELECTION": one_elsewhere}),
    "T-5.1": offset("z_{min,1}", value=113.2),
    "T-5.2": world(  # a wall in use that one of the two units puts out of reach
        printed={
            "OFFSETS": tuple(
                replace(o, value=-300.0) if o.label == "x_{min,2}" else o for o in paper.OFFSETS
            )
        },
        robots={"minervabot-v2": with_boundaries(robot_file(), B6={"used": True})},
    ),
    "T-5.3": world(printed={"SELECTION": one_elsewhere}),
    "T-5.4": world(printed={"SELECTION": one_elsewhere}),
    "T-5.5": world(printed={"TABLE_5": {6: ("S_x", "x_{min,1}")}}),
    "T-5.6": world(printed={"TABLE_5": {7: ("S_x", "z_{min,1}")}}),
    "T-6": bound("1,1", "+ acos", "- 2*acos", k=(1,)),
    "T-6.1": bound("1,1", "arctan(z_1_7, x_1_7)", "arctan(x_1_7, z_1_7)"),
    "T-6.2": bound("1,3", "- acos", "+ acos"),
    "T-6.3": bound("2,1", "arctan(z_1_9, x_1_9)", "pi + arctan(z_1_9, x_1_9)"),
    "T-6.4": bound("2,3", "- acos", "+ acos"),
    "T-6.5": bound("3,1", "- acos", "+ acos"),
    "T-6.6": bound("3,3", "arctan(-x_2_11, z_2_11)", "arctan(x_2_11, -z_2_11) - pi"),
    "T-6.7": bound("4,1", "- acos", "+ acos"),
    "T-6.8": bound("4,3", "- acos", "+ acos"),
    "T-6.9": bound("5,1", "- acos", "+ acos", k=(2,)),
    "T-6.10": bound("6,1", "- acos", "+ acos", k=(2,)),
    "T-6.11": world(
        printed={"TABLE_6": {"beta_{7,3,2}": f"{paper.TABLE_6['beta_{7,3,1}']} - 2*pi"}}
    ),
}
