# ruff: noqa: E501  (robots and a table)
"""Robots and certificates of every kind, small enough to be read: what checkers are tested on."""

from __future__ import annotations

import copy
from collections.abc import Callable
from functools import cache
from typing import Any

from engine_support import planar
from engine_support.certificates import no_path, proved, refuted

Json = Any

ARM = """schema = 1
name = "arm"
length_unit = "cm"
angle_unit = "deg"
home = { q1 = 0, q2 = 0 }
tool = "tip"
joint = [
  { name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 2], axis = [0, 1, 0] },
  { name = "q2", type = "revolute", parent = "1", frame = "2", origin = [3, 0, 0], axis = [0, 1, 0], limits = [-170, 170] },
]
point = [
  { name = "tip", frame = "2", at = [2, 0, 0], radius = 0.25 },
  { name = "post", frame = "0", at = [0, 0, 4.5] },
]
boundary = [
  { name = "floor", type = "half-space", point = "tip", normal = [0, 0, 1], offset = -1.5 },
  { name = "gap", type = "pair", points = ["tip", "post"], clearance = 0.5 },
  { name = "spare", type = "half-space", point = "tip", normal = [1, 0, 0], offset = 90, used = false },
]
"""
"""Stretched along x at height 2; q1 turns the tip downwards."""

BODIES = """schema = 1
name = "bodies"
length_unit = "m"
angle_unit = "deg"
home = { q1 = 0, q2 = 0 }
tool = "tip"
collisions = "all"
clearance = 0.01
allowed = [["upper arm", "hand"]]
joint = [
  { name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1], limits = [-170, 170] },
  { name = "q2", type = "revolute", parent = "1", frame = "2", origin = [0.5, 0, 0], axis = [0, 0, 1], limits = [-170, 170] },
]
point = [
  { name = "tip", frame = "2", at = [0.4, 0, 0] },
]
body = [
  { name = "upper arm", frame = "1", capsule = { from = [0, 0], to = [0.5, 0], radius = 0.04 } },
  { name = "hand", frame = "2", polygon = [[0.4, 0.03], [0.4, -0.03], [-0.05, -0.03], [-0.05, 0.03]] },
]
obstacle = [
  { name = "crate", polygon = [[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]] },
  { name = "pillar", disc = { at = [-0.3, 0.5, 0], radius = 0.1 } },
  { name = "hook", polygon = [[0.2, -0.9], [0.8, -0.9], [0.8, -0.4], [0.7, -0.4], [0.7, -0.8], [0.45, -0.8], [0.2, -0.8]] },
]
boundary = [
  { name = "floor", type = "half-space", body = "hand", normal = [0, 1, 0], offset = -0.75 },
]
"""
"""Two links in the plane of x and y, amid a crate, a pillar and a hook that is not convex."""

SEGMENTS = """schema = 1
name = "segments"
length_unit = "m"
angle_unit = "deg"
home = { q1 = 0 }
tool = "tip"
joint = [{ name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1] }]
point = [{ name = "tip", frame = "1", at = [1, 0, 0] }]
body = [{ name = "rod", frame = "1", capsule = { from = [0, 0], to = [1, 0], radius = 0 } }]
obstacle = [{ name = "wire", capsule = { from = [0.5, 0.5], to = [0.9, 0.5], radius = 0 } }]
collisions = "all"
"""
"""Two segments that keep no distance: crossing them is all that is forbidden."""

LIFT = """schema = 1
name = "lift"
length_unit = "m"
angle_unit = "rad"
home = { q1 = 0, q2 = 0, q3 = 0 }
tool = "tip"
joint = [
  { name = "q1", type = "parallelogram", parent = "0", frame = "2", bar = "1", origin = [0, 0, 1], crank = [2, 0, 0], axis = [0, 1, 0], limits = [-1, 1] },
  { name = "q2", type = "prismatic", parent = "2", frame = "3", origin = [0.5, 0, 0], rpy = [0.1, 0.2, 0.3], axis = [0, 0, 2], limits = [-0.5, 0.5] },
  { name = "q3", type = "revolute", parent = "3", frame = "4", origin = [0, 0.25, 0], axis = [1, 1, 0] },
]
point = [
  { name = "tip", frame = "4", at = [0.5, 0, 0], radius = 0.125 },
  { name = "eye", frame = "1", at = [1, 0, 1.5] },
]
boundary = [
  { name = "floor", type = "half-space", point = "tip", normal = [0, 0, 3], offset = 0.25 },
  { name = "sight", type = "pair", points = ["eye", "tip"], clearance = 0.5 },
]
"""
"""A parallelogram, a slide and a skew turn, in radians; a point of the bar."""

SQUARE = [["0", "0"], ["8", "0"], ["8", "8"], ["0", "8"]]
HALVES = [[0, 1, 2], [0, 2, 3]]
INNER = [["2", "2"], ["2", "6"], ["6", "6"], ["6", "2"]]
RING = [[0, 1, 7], [0, 7, 4], [1, 2, 6], [1, 6, 7], [2, 3, 5], [2, 5, 6], [3, 0, 4], [3, 4, 5]]


def box(low: str, high: str, margin: str = "0") -> Json:
    return {"set": "box", "margin": margin, "points": [[low.split(), high.split()]]}


def path(*lists: str) -> Json:
    return {"set": "path", "points": [[q.split() for q in row.split(", ")] for row in lists]}


def polygon(points: Json, triangles: Json) -> Json:
    return {"set": "polygon", "points": points, "triangles": triangles}


def between(start: str, goal: str, joints: str) -> Json:
    return {"points": [[start.split(), goal.split()]], "joints": joints.split()}


def moved(loop: Json, by: int) -> Json:
    return [[str(int(x) + by), str(int(y) + by)] for x, y in loop]


TWINS = ARM.replace(
    "point = [", 'point = [\n  { name = "mast", frame = "0", at = [0, 0.0, 4.5] },'
).replace(
    "boundary = [", 'boundary = [\n  { name = "sight", type = "pair", points = ["mast", "tip"] },'
)
FREE = ARM.split("boundary = [", maxsplit=1)[0]
"""The arm with nothing to keep."""
MEETING = (
    FREE.replace(", radius = 0.25", "")
    + 'boundary = [{ name = "rest", type = "pair", points = ["tip", "post"] }]\n'
)
"""The arm with two points of no size, which may meet."""
DOTTED = SEGMENTS.replace(
    '"rod", frame = "1", capsule = { from = [0, 0], to = [1, 0], radius',
    '"hand", frame = "1", disc = { at = [0.75, 0], radius',
)
"""A point that passes through a segment, both without thickness."""
TILTED = """schema = 1
name = "tilted"
length_unit = "mm"
angle_unit = "deg"
home = { q1 = 0 }
tool = "tip"
joint = [{ name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [1e-13, 0, 1] }]
point = [{ name = "tip", frame = "1", at = [1, 0, 0] }]
body = [{ name = "rod", frame = "1", disc = { at = [1e-10, 0, 1000], radius = 0 } }]
obstacle = [{ name = "post", disc = { at = [1e-10, 0, 1000], radius = 0 } }]
collisions = "all"
clearance = 5e-11
"""
"""The rod is on the axis a meter up, where the post is; seen along the base's z it moves by 1e-10."""
BOOM = planar.planar(
    "",
    "[-0.7, 0.2]",
    slide=True,
    posts=planar.post("north", 0, 1.2, 1.2) + planar.post("south", 0, -1.2, 1.2),
)
SHORT = planar.planar(
    "", "", posts=planar.post("north", 0, 1, 1.2) + planar.post("south", 0, -1, 1.2)
)
WIDE = planar.turning().replace("origin = [0, 0, 0]", "origin = [0, 0, 0]\nlimits = [-200, 200]")

MAKERS: dict[str, tuple[str, Callable[[], Json]]] = {
    "box": ("proved", lambda: proved(ARM, box("-10 -20", "8 12"))),
    "box of one place": ("proved", lambda: proved(ARM, box("1 2", "1 2"))),
    "box of one joint": ("proved", lambda: proved(ARM, box("-1 2", "1 2"))),
    "up to a limit": ("proved", lambda: proved(ARM, box("0 160", "1 170.0"))),
    "path": ("proved", lambda: proved(ARM, path("0 0, 4 4, 8 0", "0 0, 0 0"))),
    "polygon": ("proved", lambda: proved(ARM, polygon([SQUARE], HALVES))),
    "ring": ("proved", lambda: proved(ARM, polygon([SQUARE, INNER], RING))),
    "two squares": ("proved", lambda: proved(ARM, polygon([SQUARE, moved(SQUARE, 8)], [*HALVES, *([i + 4 for i in row] for row in HALVES)]))),
    "bodies": ("proved", lambda: proved(BODIES, box("-15 -15", "15 15"))),
    "bodies beside the crate": ("proved", lambda: proved(BODIES, box("60 -20", "90 20"))),
    "bodies, path": ("proved", lambda: proved(BODIES, path("60 -20, 90 20, 95 0"))),
    "bodies, square": ("proved", lambda: proved(BODIES, polygon([moved(SQUARE, 2)], HALVES) | {"margin": "0.01"})),
    "bodies, triangles": ("proved", lambda: proved(BODIES, polygon([[["60", "-20"], ["90", "-20"], ["90", "20"], ["60", "20"]]], HALVES))),
    "two points of one place": ("proved", lambda: proved(TWINS, box("-10 -20", "8 12"))),
    "segments": ("proved", lambda: proved(SEGMENTS, box("60", "120"))),
    "lift": ("proved", lambda: proved(LIFT, box("-0.3 -0.1 -0.2", "0.1 0.2 0.3"))),
    "lift, path": ("proved", lambda: proved(LIFT, path("-0.2 -0.1 0, 0.1 0.2 9"))),
    "points that meet": ("proved", lambda: proved(MEETING, box("-10 -20", "8 12"))),
    "points that meet, margin": ("proved", lambda: proved(MEETING, box("-10 -20", "8 12") | {"margin": "0.1"})),
    "bodies that meet": ("proved", lambda: proved(DOTTED, box("0", "120"))),
    "no thing to keep": ("proved", lambda: proved(FREE, box("0 0", "1 1"))),
    "witness": ("refuted", lambda: refuted(ARM, box("0 0", "90 1"), at=["90", "0.5"])),
    "witness of a pair": ("refuted", lambda: refuted(ARM, box("-90 -130", "0 95"), at=["-48", "-124"])),
    "witness of a cell": ("refuted", lambda: refuted(ARM, path("0 0, 4 4", "0 0, 90 0"), cell=1, weights=["0.25", "0.75"] )),
    "witness of a triangle": ("refuted", lambda: refuted(BODIES, polygon([moved(SQUARE, 30)], HALVES), cell=1, weights=["0.5", "0.25", "0.25"] )),
    "witness in the crate": ("refuted", lambda: refuted(BODIES, box("0 0", "40 9"), at=["38", "4"])),
    "witness a meter up": ("refuted", lambda: refuted(TILTED, box("0", "180"), at=["180"])),
    "witness at heights nearly the same": ("refuted", lambda: refuted(BODIES.replace("at = [-0.3, 0.5, 0], radius = 0.1", "at = [0.375, 0, 4e-13], radius = 0") .replace("clearance = 0.01", "clearance = 1e-13") .replace("radius = 0.04", "radius = 0"), box("0 0", "1 90"), at=["0", "90"])),
    "witness of a crossing": ("refuted", lambda: refuted(SEGMENTS, box("0", "90"), at=["35"])),
    "limit": ("refuted", lambda: refuted(ARM, box("0 0", "1 171"), at=["0", "170.5"])),
    "no path": ("proved", lambda: no_path(planar.turning(), between("70", "-100", "moves"))),
    "no path, radians": ("proved", lambda: no_path(planar.turning("rad"), between("1.2", "-1.9", "moves"))),
    "no path in wide limits": ("proved", lambda: no_path(WIDE, between("-199", "161", "moves")) ),
    "no path over seams": ("proved", lambda: no_path(planar.round_both(), between("50 110", "166 0", "moves moves"), depth=10)),
    "no path, one held": ("proved", lambda: no_path(planar.telescope(), between("0 -0.3", "175 -0.3", "moves held"), depth=8)),
    "no path, sliding": ("proved", lambda: no_path(planar.telescope(), between("0 -0.3", "175 -0.3", "moves moves"), depth=12)),
    "no path, any turn": ("proved", lambda: no_path(SHORT, between("0 0", "180 9", "moves any"))),
    "no path, any slide": ("proved", lambda: no_path(BOOM, between("0 0", "180 -0.3", "moves any")) ),
}  # fmt: skip
"""Verdict and maker of each original."""


@cache
def _original(name: str) -> Json:
    return MAKERS[name][1]()


def original(name: str) -> Json:
    """Return a certificate that may be changed."""
    return copy.deepcopy(_original(name))
