"""Check a certificate of qbound a second time, in ball arithmetic (Arb), on another way.

It shares no line with `check`: kinematics goes through 4 x 4 matrices of balls, a boundary function
is found from its values at third parts of a turn, and trees are walked with a stack of cells. What
it proves is the same inequality on each leaf (not in the paper; `minorant` says why it suffices).
"""

from __future__ import annotations

import hashlib
import itertools
import json
import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from qbound.extras import require
from qbound.proofs.verdict import Verdict

BITS = 160
"""Bits of the balls: a leaf has 1e-13 of its amplitudes to spare, ``2**-43``."""

Table = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Wave:
    """The real part of `amplitude` times exp(i turns . q), times q_j to the powers."""

    amplitude: Any
    turns: tuple[int, ...]
    powers: tuple[int, ...]


def verify(text: str) -> Verdict:
    """Return what a certificate proves: that its statement is true, or that it is not.

    Parameters
    ----------
    text : str
        The certificate.

    Raises
    ------
    ValueError
        If it does not prove what it says.
    ModuleNotFoundError
        Without python-flint (the extra `proofs`).

    Examples
    --------
    >>> from qbound.model.robotfile import robot_text
    >>> from qbound.proofs.certify import certify
    >>> from qbound.proofs.statements import box
    >>> text, _ = robot_text("minervabot-v2")
    >>> proof = certify(text, box(["-10", "-10"], ["10", "10"])).text
    >>> verify(proof).value
    'proved'

    A proof of another robot is none:

    >>> verify(proof.replace("11.32", "11.33"))
    Traceback (most recent call last):
    ValueError: the hash is not of this robot
    """
    require("flint")
    from flint import ctx

    with ctx.workprec(BITS):
        content = json.loads(text)
        robot = tomllib.loads(content["robot"], parse_float=str)
        if hashlib.sha256(content["robot"].encode()).hexdigest() != content["sha256"]:
            raise ValueError("the hash is not of this robot")
        if content["schema"] != "qbound/certificate/1":
            raise ValueError(f"{content['schema']}: an unknown schema")
        if _exact(content["statement"]["margin"]) < 0:
            raise ValueError("a negative margin")
        cells = _cells(content["statement"])
        verdict = Verdict(content["verdict"])
        if verdict is Verdict.REFUTED:
            _refute(robot, content, cells)
        elif verdict is Verdict.PROVED and cells:
            _prove(robot, content, cells)
        else:
            raise ValueError("it says nothing")
    return verdict


def _prove(robot: Table, content: Table, cells: Sequence[Any]) -> None:
    for corner in itertools.chain.from_iterable(cells):
        for name, distance in _limits(robot, corner):
            if distance < 0:
                raise ValueError(f"{corner} is beyond {name}")
    for wall in robot.get("boundary", []):
        if wall.get("used", True) and _gap(robot, wall, content) != (0, True):
            waves = _waves(robot, wall, content)
            for cell, tree in zip(cells, content["proof"][wall["name"]], strict=True):
                if not _covers(robot, waves, cell, tree):
                    raise ValueError(f"{wall['name']}: not proved")


def _refute(robot: Table, content: Table, cells: Sequence[Any]) -> None:
    weights = [_exact(w) for w in content["weights"]]
    if min(weights) < 0 or sum(weights) != 1:
        raise ValueError("no weights")
    columns = zip(*cells[content["cell"]], strict=True)
    q = [sum(x * w for x, w in zip(column, weights, strict=True)) for column in columns]
    walls = {w["name"]: w for w in robot.get("boundary", []) if w.get("used", True)}
    if content["boundary"] in walls:
        value = _value(robot, walls[content["boundary"]], content)
        violated = value([x * u for x, u in zip(q, _units(robot), strict=True)]) < 0
    else:
        violated = dict(_limits(robot, q))[content["boundary"]] < 0
    if not violated:
        raise ValueError("the witness violates nothing")


# --- numbers, kinematics --------------------------------------------------------------------------


def _exact(decimal: Any) -> Any:
    """Read a decimal as a fraction."""
    from flint import fmpq

    if not isinstance(decimal, str | int) or set(str(decimal)) - set("+-.0123456789_eE"):
        raise ValueError(f"{decimal}: wanted a decimal as text")
    digits, _, exponent = str(decimal).lower().replace("_", "").partition("e")
    whole, _, decimals = digits.partition(".")
    power = int(exponent or 0) - len(decimals)
    if abs(power) > 200:
        raise ValueError(f"{decimal}: too large or too small")
    return fmpq(int(whole + decimals)) * fmpq(10) ** power


def _units(robot: Table) -> list[Any]:
    from flint import arb

    angle = arb.pi() / 180 if robot["angle_unit"] == "deg" else arb(1)
    return [angle if joint["type"] == "revolute" else arb(1) for joint in robot["joint"]]


def _limits(robot: Table, q: Sequence[Any]) -> Iterator[tuple[str, Any]]:
    for joint, x in zip(robot["joint"], q, strict=True):
        if "limits" in joint:
            yield f"{joint['name']}.lower", x - _exact(joint["limits"][0])
            yield f"{joint['name']}.upper", _exact(joint["limits"][1]) - x


def _gap(robot: Table, wall: Table, content: Table) -> tuple[Any, bool]:
    """Return the distance asked for (of a wall its offset), and whether it is of a pair."""
    pair = wall["type"] == "pair"
    names = wall["points"] if pair else [wall["point"]]
    radii = [_exact(p.get("radius", 0)) for p in robot["point"] if p["name"] in names]
    own = wall.get("clearance", 0) if pair else wall["offset"]
    return sum(radii, _exact(own) + _exact(content["statement"]["margin"])), pair


def _value(robot: Table, wall: Table, content: Table) -> Callable[[Sequence[Any]], Any]:
    """Return the boundary function of joint values (rad, length) as balls."""
    points = {p["name"]: p for p in robot["point"]}
    frames = [robot["joint"][0]["parent"], *(joint["frame"] for joint in robot["joint"])]
    gap, pair = _gap(robot, wall, content)

    def place(name: str, q: Sequence[Any]) -> Any:
        depth = frames.index(points[name]["frame"])
        matrix = _translation([_exact(x) for x in points[name]["at"]])
        for joint, x in reversed(list(zip(robot["joint"], q, strict=True))[:depth]):
            matrix = _joint(joint, x, robot["angle_unit"]) * matrix
        return [matrix[i, 3] for i in range(3)]

    def beta(q: Sequence[Any]) -> Any:
        if pair:
            a, b = (place(name, q) for name in wall["points"])
            return sum((x - y) ** 2 for x, y in zip(a, b, strict=True)) - gap * gap
        n = _direction(wall["normal"])
        return sum(x * y for x, y in zip(n, place(wall["point"], q), strict=True)) - gap

    return beta


def _direction(values: Sequence[Any]) -> list[Any]:
    from flint import arb

    exact = [_exact(x) for x in values]
    length = arb(sum(x * x for x in exact)).sqrt()
    return [x / length for x in exact]


def _translation(by: Sequence[Any]) -> Any:
    from flint import arb_mat

    x, y, z = by
    return arb_mat([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]])


def _rotation(axis: Sequence[Any], angle: Any) -> Any:
    """I + sin K + (1 - cos) K^2, with K the matrix of the cross product."""
    from flint import arb, arb_mat

    x, y, z = axis
    k = arb_mat([[0, -z, y, 0], [z, 0, -x, 0], [-y, x, 0, 0], [0, 0, 0, 0]])
    one = arb_mat([[int(i == j) for j in range(4)] for i in range(4)])
    angle = arb(angle)
    return one + k * angle.sin() + k * k * (1 - angle.cos())


def _joint(joint: Table, q: Any, unit: str) -> Any:
    from flint import arb

    radian = arb.pi() / 180 if unit == "deg" else arb(1)
    matrix = _translation([_exact(x) for x in joint["origin"]])
    for letter, angle in zip("zyx", reversed(joint.get("rpy", [0, 0, 0])), strict=True):
        fixed = [arb(int(other == letter)) for other in "xyz"]
        matrix = matrix * _rotation(fixed, _exact(angle) * radian)
    axis = _direction(joint["axis"])
    if joint["type"] == "revolute":
        return matrix * _rotation(axis, q)
    return matrix * _translation([q * x for x in axis])


# --- waves ----------------------------------------------------------------------------------------


def _waves(robot: Table, wall: Table, content: Table) -> list[Wave]:
    """Interpolate: values at 0, 1/3, 2/3 of a turn, or at slides of 0, 1, -1, determine a form."""
    from flint import acb, arb

    beta, n = _value(robot, wall, content), len(robot["joint"])
    kinds = [joint["type"] == "revolute" for joint in robot["joint"]]
    third = 2 * arb.pi() / 3
    nodes = [[0 * third, third, 2 * third] if r else [arb(0), arb(1), arb(-1)] for r in kinds]
    grid = itertools.product(range(3), repeat=n)
    values = {k: acb(beta([nodes[j][k[j]] for j in range(n)])) for k in grid}
    root = (acb(0, 1) * third).exp()
    fourier = [[root ** (-w * k) / 3 for k in range(3)] for w in (0, 1, -1)]
    half = acb(1) / 2
    powers = [[acb(1), acb(0), acb(0)], [acb(0), half, -half], [acb(-1), half, half]]
    for j, turning in enumerate(kinds):
        weights = fourier if turning else powers
        values = {
            k: sum((weights[k[j]][i] * values[(*k[:j], i, *k[j + 1 :])] for i in range(3)), acb(0))
            for k in values
        }
    waves = []
    for k, a in values.items():
        turns = tuple((0, 1, -1)[x] if turning else 0 for x, turning in zip(k, kinds, strict=True))
        slides = tuple(0 if turning else x for x, turning in zip(k, kinds, strict=True))
        if turns >= (0,) * n:  # the other half are mirror images
            waves.append(Wave(2 * a if any(turns) else a, turns, slides))
    return waves


# --- cells ----------------------------------------------------------------------------------------


def _cells(statement: Table) -> list[list[tuple[Any, ...]]]:
    """Return the simplices of the set."""
    loops = [[tuple(_exact(x) for x in point) for point in loop] for loop in statement["points"]]
    if min(map(len, loops)) < 2:
        raise ValueError("a lone point")
    if statement["set"] == "path":
        return [[a, b] for loop in loops for a, b in itertools.pairwise(loop)]
    if statement["set"] == "box":
        [[low, high]] = loops
        return _orders(low, high)
    if statement["set"] != "polygon":
        raise ValueError("an unknown set")
    points = list(itertools.chain.from_iterable(loops))
    flat = [j for j in range(len(points[0])) if len({p[j] for p in points}) > 1]
    ring: dict[Any, int] = {}
    for loop in loops:
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
            ring[a, b] = ring.get((a, b), 0) + 1
    if any((b, a) in ring for a, b in ring):
        raise ValueError("a loop goes back along itself")
    for triangle in statement["triangles"]:
        a, b, c = (points[i] for i in triangle)
        (x, y), (u, v) = ([p[j] - a[j] for j in flat] for p in (b, c))
        if not x * v - y * u > 0:
            raise ValueError("a triangle is turned over")
        for edge in ((b, a), (c, b), (a, c)):
            ring[edge] = ring.get(edge, 0) + 1
    if any(ring.get((b, a), 0) != count for (a, b), count in ring.items()):
        raise ValueError("the triangles do not fill the polygon")
    return [[points[i] for i in triangle] for triangle in statement["triangles"]]


def _orders(low: tuple[Any, ...], high: tuple[Any, ...]) -> list[list[tuple[Any, ...]]]:
    """Cut a box into the simplices along which its joints rise one after the other."""
    wide = [j for j, (a, b) in enumerate(zip(low, high, strict=True)) if a != b]
    cells = []
    for order in itertools.permutations(wide):
        corner, cell = list(low), [low]
        for j in order:
            corner[j] = high[j]
            cell.append(tuple(corner))
        cells.append(cell)
    return cells


def _covers(robot: Table, waves: Sequence[Wave], cell: list[Any], tree: str) -> bool:
    """Tell whether a tree ends in leaves, all of them positive."""
    todo, units = [cell], _units(robot)
    for letter in tree:
        if not todo:
            return False
        top = todo.pop()
        if letter == ".":
            if not _positive(waves, [[x * u for x, u in zip(p, units, strict=True)] for p in top]):
                return False
        else:
            pairs = list(itertools.combinations(range(len(top)), 2))
            i, k = pairs["abcdefghijklmnopqrstuvwxyz".index(letter)]
            middle = tuple((x + y) / 2 for x, y in zip(top[i], top[k], strict=True))
            todo.append([*top[:i], middle, *top[i + 1 :]])
            todo.append([*top[:k], middle, *top[k + 1 :]])
    return not todo


def _positive(waves: Sequence[Wave], corners: Sequence[Sequence[Any]]) -> bool:
    """Tell whether the concave bound is positive at every corner."""
    count = len(corners)
    centre = [sum(column) / count for column in zip(*corners, strict=True)]
    steps = [[x - m for x, m in zip(corner, centre, strict=True)] for corner in corners]
    low = [0] * count
    for wave in waves:
        bounds = _wave_bounds(wave, centre, steps, corners)
        low = [total + bound for total, bound in zip(low, bounds, strict=True)]
    return all(total > 0 for total in low)


def _wave_bounds(
    wave: Wave, centre: Sequence[Any], steps: Sequence[Sequence[Any]], corners: Sequence[Any]
) -> list[Any]:
    """Value, slope and least second derivative of a wave at each corner."""
    from flint import acb, arb

    j = next((j for j, power in enumerate(wave.powers) if power), None)
    angle = sum(w * m for w, m in zip(wave.turns, centre, strict=True))
    z = wave.amplitude * (acb(0, 1) * angle).exp()
    size, turned = abs(wave.amplitude), [_dot(wave.turns, step) for step in steps]
    if j is None:
        return [z.real - z.imag * u - size * u * u / 2 for u in turned]
    u = _largest(turned)
    value, slopes = z.real, [-z.imag * t for t in turned]
    series = (arb(1), u, u * u)
    for i, power in enumerate(wave.powers):
        reach, far = _largest([c[i] for c in corners]), _largest([s[i] for s in steps])
        for _ in range(power):
            slopes = [d * centre[i] + value * s[i] for d, s in zip(slopes, steps, strict=True)]
            value = value * centre[i]
            a, b, c = series
            series = (a * reach, b * reach + a * far, c * reach + 2 * b * far)
    lone = not any(wave.turns) and sum(wave.powers) == max(wave.powers) == 2
    bend = arb(0) if lone and wave.amplitude.real > 0 else size * series[2] / 2
    return [value + slope - bend for slope in slopes]


def _dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    return sum(x * y for x, y in zip(u, v, strict=True))


def _largest(values: Sequence[Any]) -> Any:
    from flint import arb

    return arb(max(abs(arb(x)).upper() for x in values))
