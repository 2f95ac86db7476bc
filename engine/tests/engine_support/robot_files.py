"""Robot files at random, as text: any number and kind of joints, mounts, spheres, half-spaces."""

import random

ALL_KINDS = "revolute revolute prismatic parallelogram"


def robot_file(
    seed: int, joints: int = 2, kinds: str = "revolute prismatic", unit: str = "deg"
) -> str:
    """Write a robot whose numbers are short decimals, so that every reader sees the same ones."""
    rng = random.Random(seed)
    frames = ["0", *(f"f{j}" for j in range(1, joints + 1))]
    lines = [
        f'schema = 1\nname = "random"\nlength_unit = "cm"\nangle_unit = "{unit}"',
        f"home = {{ {', '.join(f'q{j} = 0' for j in range(1, joints + 1))} }}\ntool = 'tip'",
    ]
    for j in range(joints):
        kind = rng.choice(kinds.split())
        rpy = f"rpy = {_vector(rng, 90 if unit == 'deg' else 3)}\n" if rng.random() < 0.4 else ""
        limits = "limits = [-4, 6]\n" if kind == "prismatic" else ""
        if kind == "parallelogram":
            limits += f'bar = "b{j + 1}"\ncrank = {_vector(rng, 8)}\n'
        lines.append(
            f'[[joint]]\nname = "q{j + 1}"\ntype = "{kind}"\nparent = "{frames[j]}"\n'
            f'frame = "{frames[j + 1]}"\norigin = {_vector(rng, 8)}\naxis = {_vector(rng, 1)}\n'
            f"{rpy}{limits}"
        )
    bars = [f"b{j}" for j in range(len(frames)) if f'bar = "b{j}"' in "".join(lines)]
    for name, frame in [("tip", frames[-1]), ("base", "0"), ("mid", rng.choice(frames + bars))]:
        lines.append(
            f'[[point]]\nname = "{name}"\nframe = "{frame}"\nat = {_vector(rng, 9)}\n'
            f"radius = {rng.randint(0, 20) / 10}\n"
        )
    lines.append(
        '[[boundary]]\nname = "gap"\ntype = "pair"\npoints = ["tip", "base"]\n'
        f"clearance = {rng.randint(1, 90) / 10}\n"
        '[[boundary]]\nname = "floor"\ntype = "half-space"\npoint = "tip"\n'
        f"normal = {_vector(rng, 1)}\noffset = {rng.randint(-250, 20) / 10}\n"
        '[[boundary]]\nname = "other"\ntype = "half-space"\npoint = "mid"\n'
        f"normal = {_vector(rng, 1)}\noffset = {rng.randint(-250, 20) / 10}\n"
    )
    return "\n".join(lines)


def box_of(seed: int, joints: int = 2, width: int = 30) -> tuple[list[str], list[str]]:
    """Choose the ends of a box, in decimals, within the limits of the slides above."""
    rng = random.Random(seed)
    low = [rng.randint(-40, 30) / 10 for _ in range(joints)]
    high = [x + rng.randint(1, width) / 10 for x in low]
    return [str(x) for x in low], [str(x) for x in high]


def _vector(rng: random.Random, size: float) -> list[float]:
    vector = [rng.randint(-100, 100) * size / 100 for _ in range(3)]
    return [round(x, 4) for x in vector] if any(vector) else [0.0, 0.0, 1.0]
