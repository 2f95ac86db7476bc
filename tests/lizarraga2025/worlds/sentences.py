# ruff: noqa: E501  (one table, a case a line)
"""Worlds in which the entries of ``statements/sentences.toml`` come to other verdicts."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from cspace import load_robot
from cspace.geometry import polygon
from cspace.model.robot import Body, Polygon, Prismatic, Robot
from cspace.region import problem
from lizarraga2025 import printed as paper
from lizarraga2025.beyond import slides
from lizarraga2025.choices import SCALE
from lizarraga2025.evidence import arms, joint_region, proofs
from qbound import HarmonicForm, frames, traverse
from qbound.boundary import position
from qbound.traversal import Traversal
from support.worlds import (
    World,
    robot_file,
    with_boundaries,
    with_joints,
    with_points,
    world,
)

PAPER = "minervabot-v2"
ARM = robot_file(PAPER)
EVIDENCE = "lizarraga2025.evidence"


def arm(of: Robot) -> World:
    """Return a world in which the paper's robot is another one."""
    return world(robots={PAPER: of})


def with_contacts(q1: tuple[float, float], q2: tuple[float, float]) -> Robot:
    """Return the robot with its pairs in contact at other angles: the ends of q1 and q2, deg."""
    (low1, high1), (low2, high2) = np.radians([q1, q2])

    def seen(name: str, base: str, q: tuple[float, float]) -> np.ndarray:
        return ARM.frames(np.array(q)).position(base, name, base)

    return with_points(
        ARM,
        p6=seen("7", "0", (high1, 0.0)),
        p8=seen("9", "0", (low1, 0.0)),
        p10=seen("11", "1", (0.0, high2)),
        p12=seen("13", "1", (0.0, low2)),
    )


def without_bounds() -> Robot:
    """Return a robot whose windows are all one full turn, the same, and whose limit is far off."""
    r = -10.0
    points = {"p7": (r, 0, 0), "p9": (r, 0, 0), "p11": (r, 0, 0), "p13": (r, 0, 0)}
    near = ARM.joints[0].origin - [r, 0, 0], ARM.joints[1].origin - [r, 0, 0]
    points |= {"p6": near[0], "p8": near[0], "p10": near[1], "p12": near[1]}
    free = with_boundaries(with_points(ARM, **points), B7={"offset": -100.0})
    return replace(free, home=np.array([0.1, 0.1]))


def with_bodies(of: Robot, factor: float) -> Robot:
    """Return a robot whose bodies are shrunk about their middles."""
    bodies = tuple(
        replace(body, shape=Polygon(polygon.scaled(corners, factor, corners.mean(axis=0))))
        for body in of.bodies
        for corners in [body.shape.corners]
    )
    return replace(of, bodies=bodies)


def used(*names: str) -> Robot:
    """Return the robot with these boundaries in use and no others."""
    return with_boundaries(ARM, **{b.name: {"used": b.name in names} for b in ARM.boundaries})


def sliding_in_place_of_turning() -> Robot:
    """Return the robot with two slides, along x and z, in place of its joints."""
    joints = tuple(
        joint.as_type(Prismatic, axis=axis, limits=(-9.0, 9.0))
        for joint, axis in zip(ARM.joints, np.eye(3)[[0, 2]], strict=True)
    )
    return replace(ARM, joints=joints)


def linear_tool() -> HarmonicForm:
    """Return the tool's place as a linear function of the joints."""
    return position(sliding_in_place_of_turning(), ARM.tool)


def third_joint(**changes: Any) -> Callable[[], Robot]:
    """Return the arm with a slide and other boundaries, as a function."""
    return lambda: with_boundaries(SLIDING(), **changes)


def turning_third_joint() -> Robot:
    """Return the arm with a third joint that turns about y, where the slide was."""
    of = SLIDING()
    turning = of.joints[2].as_type(type(ARM.joints[0]), axis=np.array([0.0, 1.0, 0.0]), limits=None)
    return replace(of, joints=(*of.joints[:2], turning))


def slide_that_moves_nothing() -> Robot:
    """Return the arm with a slide that comes after all points."""
    of = SLIDING()
    return replace(of, points=ARM.points, boundaries=ARM.boundaries)


class OtherSign(proofs.General):
    """The chain of Theorem 1 with one sign of eq. (16) changed."""

    @property
    def B(self) -> np.ndarray:
        """The vector of eq. (16), with a plus before its last term."""
        return np.asarray(self.r_ab + self.R_ab @ self.r_bm + self.r_an)


def other_sign() -> proofs.General:
    """Return the general chain with eq. (16) changed."""
    return OtherSign(**vars(GENERAL()))


def skew_rotation(axis: Any, angle: Any) -> Any:
    """Return a rotation with one sign changed."""
    turn = np.array(ROTATION(axis, angle))
    turn[0, 2] = -turn[0, 2]
    return turn


@contextmanager
def held_on_the_other_side() -> Iterator[None]:
    """Hold joints at the values of the other sign."""

    def restrict(form: HarmonicForm, held: Mapping[int, float]) -> HarmonicForm:
        return RESTRICT(form, {joint: -value for joint, value in held.items()})

    everywhere = (patch.object(module, "restrict", restrict) for module in (problem, slides))
    with world()(), next(everywhere), next(everywhere):
        yield


def path_of_slides(order: Sequence[int], factor: float = SCALE, of: Any = None) -> Traversal:
    """Visit the same points with two slides in place of the joints: a linear map."""
    return traverse(slides.of_slides(), joint_region.scaled(factor, of)[list(order)])


def both_roots() -> dict[str, str]:
    """Return Table 6 with the other root as the lower bound of every row of a pair or a wall."""
    lower = {label: text for label, text in paper.TABLE_6.items() if label.endswith(",2}")}
    swapped = {"- acos": "+ acos", "+ acos": "- acos", "acos": "-acos"}
    return {
        label: re.sub(r"([-+] |^)acos", lambda sign: swapped[sign[0]], text)
        for label, text in lower.items()
    }


ROTATION, RESTRICT = frames.axis_rotation, slides.restrict
SLIDING, GENERAL = slides.sliding, proofs.general

HIGH_LIMIT = arm(with_boundaries(ARM, B7={"offset": 30.0}))
"""The tool's limit so high that its curve bends outward and straight edges keep it."""
FLOOR_ALONE, WITHOUT_B4 = arm(used("B7")), arm(used("B1", "B2", "B3", "B7"))
CORRECTED = arm(load_robot("minervabot-v2-corrected"))
LOW_LIMIT = arm(with_boundaries(ARM, B7={"offset": -100.0}))
CEILING = arm(with_boundaries(ARM, B7={"normal": np.array([0.0, 0.0, -1.0]), "offset": -70.0}))
"""The tool has to stay below 70 cm: a hole in the region."""
ONE_ASPECT = arm(with_contacts((-136.0, 76.0), (-50.0, 44.0)))
"""The region ends before the singular line."""
LITTLE_OF_THE_OTHER = arm(with_contacts((-136.0, 76.0), (-58.0, 44.0)))
"""The region ends at q2 = -61.5 deg, just beyond the singular line."""
UNBOUNDED = arm(without_bounds())
NEVER_SYMMETRIC = world(replaced={f"{EVIDENCE}.arms.symmetric": arms.robot})
"""The arm whose offsets are their own mirror image has paths that are no mirror images."""
SYMMETRIC = arm(load_robot("minervabot-v2-symmetric"))
SLIDES = arm(sliding_in_place_of_turning())
POINT_LIKE = world(replaced={"lizarraga2025.choices.SCALE": 1e-3})
HARDLY_SCALED = world(replaced={"lizarraga2025.choices.SCALE": 0.99})
ON_THE_BOUNDARY = world(replaced={f"{EVIDENCE}.joint_region.distance_of_the_draw": lambda: 0.0})
"""A draw of which one configuration lies on the boundary."""
LINEAR = world(replaced={f"{EVIDENCE}.arms.tool_form": linear_tool})
SIGN_OF_16 = world(replaced={f"{EVIDENCE}.proofs.general": other_sign})
OUT_OF_REACH = world(
    replaced={"lizarraga2025.beyond.slides.sliding": third_joint(B7={"offset": 1000.0})}
)

SHARED: dict[World, str] = {
    CEILING: "S-1 S-1.1 S-8 S-50",
    HIGH_LIMIT: "S-2 S-3 S-6.1 S-10 S-25 S-26 S-27 S-32 S-52 S-53",
    POINT_LIKE: "S-4 S-34 S-35 S-54",
    ON_THE_BOUNDARY: "S-6 S-8.1 S-39",
    UNBOUNDED: "S-7 S-7.2 S-38 S-40 S-41",
    WITHOUT_B4: "S-9.1 S-13 S-16.1",
    CORRECTED: "S-9.2 S-20.2 S-20.4",
    SIGN_OF_16: "S-16 S-56",
    SLIDES: "S-17.1 S-21",
    FLOOR_ALONE: "S-22 S-23 S-23.2",
    ONE_ASPECT: "S-30.1 S-42",
    NEVER_SYMMETRIC: "S-36.2 S-55",
    OUT_OF_REACH: "S-46 S-47",
    held_on_the_other_side: "S-48 S-49 S-49.1",
}
"""Worlds in which several entries turn."""

WORLDS: dict[str, World] = {
    **{name: turned for turned, names in SHARED.items() for name in names.split()},
    "S-5": LINEAR,
    "S-7.1": world(printed={"THEOREM_2": {"31 lower": "arctan(b, a) - acos(c/sqrt(a**2 + b**2)) + 2*pi*k"}}),
    "S-9": arm(replace(ARM, boundaries=ARM.boundaries[:4])),
    "S-10.1": LITTLE_OF_THE_OTHER,
    "S-11": world(replaced={"qbound.frames.axis_rotation": skew_rotation}),
    "S-11.1": world(printed={"THEOREM_1": {15: "r_ab + R_ab @ r_bm + r_an"}}),
    "S-11.2": world(printed={"OBSERVERS": {6: "right", 7: "right", 25: "right"}}),
    "S-11.3": world(printed={"THEOREM_1": dict.fromkeys(paper.THEOREM_1, "r_1 + R_1 @ r_2")}),
    "S-11.4": arm(with_points(ARM, p7=(4.91, 0, 11.5))),
    "S-12": arm(replace(ARM, bodies=(Body("0", "0", Polygon.of([(-40, 0), (40, 0), (40, 2), (-40, 2)])), *ARM.bodies[1:]))),
    "S-12.1": arm(with_joints(ARM, q2={"limits": (-1.0, 0.5)})),
    "S-14": arm(with_boundaries(ARM, B1={"points": ("6", "11")})),
    "S-15": arm(with_joints(ARM, q1={"axis": np.array([0.0, 0.0, 1.0])})),
    "S-17": arm(replace(ARM, boundaries=ARM.boundaries[1:])),
    "S-18": arm(with_points(ARM, p7=(1, 0, 0), p9=(1, 0, 0), p11=(1, 0, 0), p13=(1, 0, 0))),
    "S-19": SYMMETRIC,
    "S-20": arm(with_boundaries(ARM, B6={"offset": 15.0})),
    "S-20.1": arm(with_boundaries(ARM, B5={"offset": -100.0}, B6={"offset": -100.0})),
    "S-20.3": world(printed={"TABLE_6": {"beta_{1,3,1}": paper.TABLE_6["beta_{1,3,1}"].replace("pi +", "")}}),
    "S-20.5": world(printed={"TABLE_6": both_roots()}),
    "S-21.1": world(printed={"TABLE_6": {"beta_{1,1,1}": paper.TABLE_6["beta_{1,1,2}"], "beta_{1,1,2}": paper.TABLE_6["beta_{1,1,1}"],}}),
    "S-21.2": world(printed={"THEOREM_2": {"31 lower": "arctan(b, a) - acos(c/sqrt(a**2 + b**2)) + 2*pi*k"}}),
    "S-23.1": arm(with_boundaries(ARM, B7={"offset": 60.0})),
    "S-23.3": world(replaced={f"{EVIDENCE}.arms.every_component": lambda: [arms.floor()]}),
    "S-24": LOW_LIMIT,
    "S-28": arm(with_bodies(ARM, 0.5)),
    "S-29": world(replaced={f"{EVIDENCE}.tool_paths.path_through": path_of_slides}),
    "S-30": arm(with_points(ARM, p3=(25, 5, 0))),  # off the plane of link 1
    "S-31": arm(with_points(ARM, p3=(0, 0, 0))),  # on the axis of joint 2
    "S-33": HARDLY_SCALED,
    "S-36": world(replaced={"lizarraga2025.choices.SCALE": 0.3}),
    "S-36.1": world(replaced={"lizarraga2025.choices.SCALE": 1.0}),
    "S-37": world(printed={"ON_NUMERICAL_METHODS": (11, paper.ON_NUMERICAL_METHODS[1])}),
    "S-43": world(replaced={"lizarraga2025.beyond.slides.sliding": turning_third_joint}),
    "S-44": world(replaced={"lizarraga2025.beyond.slides.sliding": slide_that_moves_nothing}),
    "S-45": world(replaced={"lizarraga2025.beyond.slides.of_slides": lambda: ARM}),
    "S-51": world(printed={"EQUATION_29": {"beta_{1,1}": "x_1_7*cos(q1) - x_0_6 - z_1_7*sin(q1)"}}),
}  # fmt: skip
