"""Worlds in which the entries of ``statements/equations.toml`` come to other verdicts."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.evidence import proofs
from lizarraga2025.evidence.proofs import General
from qbound.arrays import times
from qbound.frames import Frame, Frames
from support.worlds import World, robot_file, with_boundaries, with_points, world
from worlds.sentences import arm, with_contacts


@cache
def with_a_sign(equation: int, old: str, new: str) -> World:
    """Return the world that prints a right side of Theorem 1 with another sign."""
    text = paper.THEOREM_1[equation]
    assert old in text
    return world(printed={"THEOREM_1": {equation: text.replace(old, new)}})


@cache
def with_theorem_2(**sides: str) -> World:
    """Return the world that prints sides of Theorem 2 otherwise: ``_34_theta="atan2(b, a)"``."""
    changed = {name.removeprefix("_").replace("_", " "): text for name, text in sides.items()}
    assert changed.keys() <= paper.THEOREM_2.keys()
    return world(printed={"THEOREM_2": changed})


def with_a_number(label: str) -> World:
    """Return the world that prints a limit which the paper leaves open."""
    assert label not in paper.offsets_in_cm()
    return world(printed={"OFFSETS": (*paper.OFFSETS, paper.Offset(label, 0.1, "cm", 1))})


@cache
def with_component(name: str, old: str, new: str) -> World:
    text = paper.EQUATION_29[name]
    assert old in text
    return world(printed={"EQUATION_29": {name: text.replace(old, new, 1)}})


def skewed() -> General:
    """Return the general chain with one sign of each matrix changed: no rotations any more."""
    g = SOUND()
    R_0a, R_ab = (R * SIGNS for R in (g.R_0a, g.R_ab))
    links = [
        Frame("a", "0", R_0a, g.r_0a),
        Frame("a+n", "a", proofs.UNTURNED, g.r_an),
        Frame("b", "a", R_ab, g.r_ab),
        Frame("b+m", "b", proofs.UNTURNED, g.r_bm),
    ]
    return replace(g, chain=Frames("0", links), R_0a=R_0a, R_ab=R_ab)


SOUND = proofs.general
SIGNS = np.array([[-1, 1, 1], [1, 1, 1], [1, 1, 1]])


def summed(self: Frames, a: str, b: str, observer: str) -> Any:
    """Return the sum of two places where their difference is meant."""
    seen_from_base = self._pose(b).origin + self._pose(a).origin
    return times(self._pose(observer).rotation.mT, seen_from_base)


def is_parent(self: Frames, a: str, b: str) -> bool:
    """Tell whether a comes right before b: a relation that does not pass on."""
    return self._parents.get(b) == a


SKEWED = world(replaced={"lizarraga2025.evidence.proofs.general": skewed})
BRACKET_15, BRACKET_16, BRACKET_26, BRACKET_27 = (
    with_a_sign(n, "- r_an", "+ r_an") for n in (15, 16, 26, 27)
)
ROBOT = robot_file()


def with_a_point_at(name: str, at: tuple[float, float, float]) -> World:
    """Return the world in which a point is elsewhere, with x_{2,13} as printed and corrected."""
    files = {file: robot_file(file) for file in ("minervabot-v2", "minervabot-v2-corrected")}
    moved = {file: with_points(robot, **{f"p{name}": at}) for file, robot in files.items()}
    return world(robots=moved)


WORLDS: dict[str, World] = {
    **dict.fromkeys(("E-1", "E-2", "E-3", "E-6", "E-7"), SKEWED),
    "E-3.1": BRACKET_15,
    "E-4": world(replaced={"qbound.frames.Frames.position": summed}),
    "E-5": world(replaced={"qbound.frames.Frames.precedes": is_parent}),
    "E-8": world(printed={"UNIT_VECTOR": paper.UNIT_VECTOR.replace("+ z", "- z")}),
    "E-9": arm(with_contacts((-60.0, 76.0), (-134.0, 44.0))),  # (-90°, 0°) is shut
    "E-9.1": with_component("beta_{5,1}", "- x_min_1", "+ x_min_1"),
    "E-9.2": world(
        printed={"TABLE_6": {"beta_{1,1,1}": paper.TABLE_6["beta_{1,1,2}"] + " - 2*pi"}}
    ),
    "E-10": with_a_number("q_{1,max}"),
    "E-11": with_a_number("d_{min}"),
    "E-12": world(robots={"minervabot-v2": with_boundaries(ROBOT, B7={"used": False})}),
    "E-13": with_a_sign(19, "- r_0an", "+ r_0an"),
    "E-14": with_a_sign(14, "+ z", "- z"),
    "E-15": BRACKET_15,
    "E-16": BRACKET_16,
    "E-17": BRACKET_16,
    "E-17.1": with_a_point_at("6", (7.5, 0, 11.5)),
    "E-17.2": with_a_point_at("8", (-7.5, 0, 11.5)),
    "E-17.3": with_a_point_at("11", (9.59, 0, -5.25)),
    "E-17.4": with_a_point_at("13", (9.09, 0, 5.25)),
    "E-18": with_a_sign(18, "+ R_1", "- R_1"),
    "E-18.1": with_a_sign(18, "+ R_1", "- R_1"),
    "E-19": with_a_sign(19, "- r_0an", "+ r_0an"),
    "E-20": with_a_sign(20, "+ R_0a", "- R_0a"),
    "E-21": with_a_sign(21, "+ R_0b", "- R_0b"),
    "E-22": with_a_sign(22, "- (r_0a", "+ (r_0a"),
    "E-23": with_a_sign(23, "- R_0a", "+ R_0a"),
    "E-24": with_a_sign(24, "- R_0a", "+ R_0a"),
    "E-24.1": world(printed={"ROTATIONS_IN_A_ROW": "R_ab @ R_0a"}),
    "E-25": with_a_sign(25, "- r_an", "+ r_an"),
    "E-26": BRACKET_26,
    "E-27": BRACKET_27,
    "E-28": BRACKET_27,
    "TH-1": BRACKET_16,
    "E-29": with_component("beta_{1,1}", "+ z_1_7", "- z_1_7"),
    "E-29.1.1": with_component("beta_{1,1}", "+ z_1_7", "- z_1_7"),
    "E-29.1.3": with_component("beta_{1,3}", "- x_1_7", "+ x_1_7"),
    "E-29.2.1": with_component("beta_{2,1}", "+ z_1_9", "- z_1_9"),
    "E-29.2.3": with_component("beta_{2,3}", "- x_1_9", "+ x_1_9"),
    "E-29.3.1": with_component("beta_{3,1}", "+ z_2_11", "- z_2_11"),
    "E-29.3.3": with_component("beta_{3,3}", "- x_2_11", "+ x_2_11"),
    "E-29.4.1": with_component("beta_{4,1}", "+ z_2_13", "- z_2_13"),
    "E-29.4.3": with_component("beta_{4,3}", "- x_2_13", "+ x_2_13"),
    "E-29.5.1": with_component("beta_{5,1}", "- sin(q1)", "+ sin(q1)"),
    "E-29.6.1": with_component("beta_{6,1}", "- sin(q1)", "+ sin(q1)"),
    "E-29.7.3": with_component("beta_{7,3}", "- x_2_3", "+ x_2_3"),
    "E-30": with_component("beta_{1,1}", "cos(q1)", "cos(q1)**2"),
    "E-32": with_component("beta_{1,1}", "cos(q1)", "cos(q1)**2"),
    **dict.fromkeys(
        ("E-31", "TH-2"),
        with_theorem_2(_31_lower=paper.THEOREM_2["31 lower"].removesuffix(" - 2*pi")),
    ),
    "E-33": with_theorem_2(_33="d*cos(q + theta)"),
    "E-34": with_theorem_2(_34_theta="atan2(b, a)"),
    "E-35": with_theorem_2(_35="-c/d"),
    "E-36": with_theorem_2(_36_lower="0"),
    "E-37": with_theorem_2(_37="pm*acos(c/d) + 2*pi*k"),
    "E-39.2": with_theorem_2(_37="pm*acos(c/d) + 2*pi*k"),
    "E-38": with_theorem_2(_38="atan2(b, a) + acos(c/d) + 2*pi*k"),
    "E-39": with_theorem_2(_39_lower="arctan(b, a) + acos(c/d) + 2*pi*k - pi"),
    "E-39.1": world(
        printed={"TABLE_6": {"beta_{7,3,2}": paper.TABLE_6["beta_{7,3,1}"] + " - 2*pi"}}
    ),
}
