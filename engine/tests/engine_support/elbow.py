# ruff: noqa: E501  (rows of robot files, one a line)
"""An arm of three joints that turn, whose elbow is blocked in closed form, and a cart, as text."""

import math

CLOSED = math.acos(-0.92)
"""|r|^2 = 1/2 + 1/2 cos q of the two balls, less than 0.2^2 where cos q < -0.92."""

TURNING = "limits = [-360, 360]"


def arm(
    elbow: str = TURNING,
    *,
    wrist: float = 0.0,
    unit: str = "deg",
    points: str = "",
    boundaries: str = "",
) -> str:
    """Write the arm: upper arm and forearm of length 1, a ball in the middle of each.

    The ball of the forearm sits beyond the wrist if `wrist` is not 0, so far off its axis.
    """
    link, at = ("hand", f"[{wrist}, 0, 0]") if wrist else ("forearm", "[0.5, 0, 0]")
    limits = f", {elbow}" if elbow else ""
    return f"""schema = 1
name = "elbow arm"
length_unit = "m"
angle_unit = "{unit}"
home = {{ shoulder = 0, elbow = 0, wrist = 0 }}
tool = "tip"
joint = [
  {{ name = "shoulder", type = "revolute", parent = "base", frame = "upper", origin = [0, 0, 0.5], axis = [0, 0, 1], limits = [-360, 360] }},
  {{ name = "elbow", type = "revolute", parent = "upper", frame = "forearm", origin = [1, 0, 0], axis = [0, 1, 0]{limits} }},
  {{ name = "wrist", type = "revolute", parent = "forearm", frame = "hand", origin = [0.5, 0, 0], axis = [0, 1, 0], limits = [-180, 180] }},
]
point = [
  {{ name = "tip", frame = "hand", at = [0.3, 0, 0] }},
  {{ name = "upper arm/1", frame = "upper", at = [0.5, 0, 0], radius = 0.1 }},
  {{ name = "{link}/1", frame = "{link}", at = {at}, radius = 0.1 }},
  {{ name = "tool/1", frame = "hand", at = [0.2, 0, 0], radius = 0.05 }},
  {points}
]
boundary = [
  {{ name = "folded", type = "pair", points = ["upper arm/1", "{link}/1"] }},
  {{ name = "floor", type = "half-space", point = "tool/1", normal = [0, 0, 1], offset = -2 }},
  {boundaries}
]
"""


SLIDE = """schema = 1
name = "slide"
length_unit = "m"
angle_unit = "deg"
home = { x = -1, q = 0 }
tool = "b/1"
joint = [
  { name = "x", type = "prismatic", parent = "base", frame = "cart", origin = [0, 0, 0], axis = [1, 0, 0], limits = [-2, 2] },
  { name = "q", type = "revolute", parent = "cart", frame = "arm", origin = [0, 0, 0], axis = [0, 1, 0] },
]
point = [
  { name = "a/1", frame = "base", at = [0, 0, 0.3], radius = 0.2 },
  { name = "b/1", frame = "cart", at = [0, 0, 0], radius = 0.3 },
  { name = "c/1", frame = "arm", at = [0.1, 0, 0], radius = 0.3 },
]
boundary = [
  { name = "passing", type = "pair", points = ["a/1", "b/1"] },
  { name = "arm passing", type = "pair", points = ["a/1", "c/1"] },
]
"""
"""A cart passes a ball: 0.3^2 + x^2 < 0.5^2 is blocked, that is |x| < 0.4."""
