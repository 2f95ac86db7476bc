"""Robots with bodies and obstacles, as text: joints of any kinds, in any plane of motion."""

import random

PLANES = {"x": (1, 2), "y": (0, 2), "z": (0, 1)}


def scene(
    seed: int, kinds: str = "RR", plane: str = "z", obstacles: int = 3, unit: str = "deg"
) -> str:
    """Write an arm amid obstacles at random; its numbers are short decimals.

    kinds : R turns, P slides, B is a parallelogram.
    """
    rng = random.Random(seed)
    axis = [int(plane == letter) * rng.choice((1, -1)) for letter in "xyz"]
    lines = [
        f'schema = 1\nname = "scene"\nlength_unit = "m"\nangle_unit = "{unit}"',
        f"home = {{ {', '.join(f'q{j + 1} = 0' for j in range(len(kinds)))} }}",
        'tool = "tip"\ncollisions = "all"',
        f"clearance = {rng.choice((0, 0.01, 0.05))}\nallowed = [['one', 'two']]",
    ]
    for j, kind in enumerate(kinds):
        along = [0, 0, 0]
        along[PLANES[plane][j % 2]] = 1  # of slides, at right angles to each other
        name = {"R": "revolute", "P": "prismatic", "B": "parallelogram"}[kind]
        limits = [-1, 1] if kind == "P" else [-170, 170] if unit == "deg" else [-2.9, 2.9]
        bar = f'bar = "b{j + 1}"\ncrank = {flat(plane, 0.3, 0.1)}\n' if kind == "B" else ""
        lines.append(
            f'[[joint]]\nname = "q{j + 1}"\ntype = "{name}"\n{bar}'
            f'parent = "{j}"\nframe = "{j + 1}"\naxis = {along if kind == "P" else axis}\n'
            f"origin = {flat(plane, 0.6 * j, 0)}\nlimits = {limits}\n"
        )
    last = len(kinds)
    lines.append(f'[[point]]\nname = "tip"\nframe = "{last}"\nat = {flat(plane, 0.5, 0)}\n')
    width = rng.randint(1, 6) / 100
    lines.append(
        f'[[body]]\nname = "one"\nframe = "1"\ncapsule = {{ from = {flat(plane, 0, 0)}, '
        f"to = {flat(plane, 0.6, 0)}, radius = {width} }}\n"
        f'[[body]]\nname = "two"\nframe = "{last}"\npolygon = {outline(rng, 0.25, 0, 0.3)}\n'
    )
    for _ in range(obstacles):
        x, y = rng.randint(-12, 12) / 10, rng.randint(-12, 12) / 10
        name = f"o{len(lines)}"
        lines.append(f'[[obstacle]]\nname = "{name}"\n{shape(rng, plane, x, y)}\n')
    lines.append(
        '[[boundary]]\nname = "floor"\ntype = "half-space"\nbody = "two"\n'
        f"normal = {flat(plane, 0, 1)}\noffset = -1.1\n"
    )
    return "\n".join(lines)


def flat(plane: str, x: float, y: float) -> list[float]:
    """Return three numbers of which two are across an axis."""
    found = [0.0, 0.0, 0.0]
    found[PLANES[plane][0]], found[PLANES[plane][1]] = x, y
    return found


def shape(rng: random.Random, plane: str, x: float, y: float) -> str:
    kind = rng.choice(("disc", "capsule", "box", "hook"))
    if kind == "disc":
        return f"disc = {{ at = {flat(plane, x, y)}, radius = {rng.randint(0, 20) / 100} }}"
    if kind == "capsule":
        end = flat(plane, round(x + 0.3, 2), round(y - 0.2, 2))
        return f"capsule = {{ from = {flat(plane, x, y)}, to = {end}, radius = 0.05 }}"
    if kind == "box":
        return f"polygon = {outline(rng, x, y, 0.2)}"
    hook = [(0, 0), (0.4, 0), (0.4, 0.1), (0.2, 0.1), (0.1, 0.1), (0.1, 0.4), (0, 0.4)]
    corners = [[round(x + a, 2), round(y + b, 2)] for a, b in hook]
    return f"polygon = {corners[:: rng.choice((1, -1))]}"


def outline(rng: random.Random, x: float, y: float, size: float) -> list[list[float]]:
    """Return a rectangle, either way round."""
    a, b = size, rng.randint(2, 20) / 100
    corners = [(-a, -b), (a, -b), (a, b), (-a, b)]
    return [[round(x + u, 3), round(y + v, 3)] for u, v in corners[:: rng.choice((1, -1))]]
