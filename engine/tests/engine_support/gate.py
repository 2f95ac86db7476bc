# ruff: noqa: E501  (rows of a robot file, one a line)
"""A body on two slides, and a gate in a wall, as wide as the body where the wall goes on at 2.3."""

GATE = """
schema = 1
name = "gate"
length_unit = "m"
angle_unit = "deg"
home = {{ x = 1, y = 1 }}
tool = "tip"
collisions = "all"
joint = [
  {{ name = "x", type = "prismatic", parent = "base", frame = "cart", axis = [1, 0, 0], origin = [0, 0, 0], limits = [0.6, 3.4] }},
  {{ name = "y", type = "prismatic", parent = "cart", frame = "hand", axis = [0, 0, 1], origin = [0, 0, 0], limits = [0.6, 3.4] }},
]
point = [{{ name = "tip", frame = "hand", at = [0, 0, 0] }}]
body = [{{ frame = "hand", name = "hand", {hand} }}]
obstacle = [
  {{ polygon = [[1.9, -1], [2.1, -1], [2.1, 1.3], [1.9, 1.3]] }},
  {{ polygon = [{upper}] }},
]
"""
HANDS = {
    "disc": "disc = { at = [0, 0], radius = 0.5 }",
    "square": "polygon = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]",
    "arrow": "polygon = [[-0.5, -0.5], [0.5, -0.5], [0.3, 0], [0.5, 0.5], [-0.5, 0.5]]",
}
UPPER = "[1.9, {0}], [2.1, {0}], [2.1, 5], [1.9, 5]"
HOOK = "[1.9, {0}], [2.1, {0}], [2.1, 5], [2, 4.5], [1.9, 5]"
"""The upper wall, convex or not."""


def gate(hand: str, upper: str) -> str:
    """The file of a hand, by name, and of the corners of the wall above the gate."""
    return GATE.format(hand=HANDS[hand], upper=upper)
