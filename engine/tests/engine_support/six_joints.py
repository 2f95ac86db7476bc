"""A six-joint arm in space with ten boundaries: kinematics as published for the UR5."""

from collections.abc import Mapping

JOINTS = (
    ("pan", [0, 0, 0.089159], [0, 0, 1]),
    ("lift", [0, 0.13585, 0], [0, 1, 0]),
    ("elbow", [0, -0.1197, 0.425], [0, 1, 0]),
    ("wrist 1", [0, 0, 0.39225], [0, 1, 0]),
    ("wrist 2", [0, 0.093, 0], [0, 0, 1]),
    ("wrist 3", [0, 0, 0.09465], [0, 1, 0]),
)
HOME = (0, -60, 80, -50, -90, 0)
POINTS = (
    ("tool", 6, [0, 0.0823, 0], 0.05),
    ("hand", 5, [0, 0, 0.05], 0.05),
    ("wrist", 4, [0, 0.05, 0], 0.05),
    ("forearm", 3, [0, 0, 0.2], 0.05),
    ("elbow point", 3, [0, 0, 0], 0.06),
    ("upper arm", 2, [0, 0, 0.2], 0.06),
    ("shoulder", 0, [0, 0, 0.15], 0.09),
    ("pedestal", 0, [0, 0, 0], 0.1),
)
PAIRS = (
    ("tool", "pedestal"),
    ("tool", "shoulder"),
    ("hand", "shoulder"),
    ("wrist", "shoulder"),
    ("tool", "upper arm"),
    ("tool", "forearm"),
)
WALLS = (
    ("floor, tool", "tool", [0, 0, 1], 0.0),
    ("floor, hand", "hand", [0, 0, 1], 0.0),
    ("ceiling", "elbow point", [0, 0, -1], -0.9),
    ("wall", "tool", [-1, 0, 0], -1.1),
)


def six_joint_arm(extra: Mapping[str, float] | None = None) -> str:
    """Write the robot file; home keeps 0.22 m or more of every boundary, less what is extra."""
    more = extra or {}
    home = ", ".join(f'"{name}" = {q}' for (name, _, _), q in zip(JOINTS, HOME, strict=True))
    lines = [
        'schema = 1\nname = "six joints"\nlength_unit = "m"\nangle_unit = "deg"',
        f'tool = "tool"\nhome = {{ {home} }}',
    ]
    for k, (name, origin, axis) in enumerate(JOINTS):
        lines.append(
            f'[[joint]]\nname = "{name}"\ntype = "revolute"\nparent = "{k}"\nframe = "{k + 1}"\n'
            f"origin = {origin}\naxis = {axis}\nlimits = [-360, 360]"
        )
    for name, frame, at, radius in POINTS:
        lines.append(f'[[point]]\nname = "{name}"\nframe = "{frame}"\nat = {at}\nradius = {radius}')
    for one, other in PAIRS:
        lines.append(
            f'[[boundary]]\nname = "{one}, {other}"\ntype = "pair"\n'
            f'points = ["{one}", "{other}"]\nclearance = {0.01 + more.get(f"{one}, {other}", 0)}'
        )
    for name, point, normal, offset in WALLS:
        lines.append(
            f'[[boundary]]\nname = "{name}"\ntype = "half-space"\npoint = "{point}"\n'
            f"normal = {normal}\noffset = {offset + more.get(name, 0)}"
        )
    return "\n".join(lines) + "\n"


def around_home(half: int) -> tuple[list[str], list[str]]:
    """Return the ends of the box of so many degrees to each side of home."""
    return [str(q - half) for q in HOME], [str(q + half) for q in HOME]
