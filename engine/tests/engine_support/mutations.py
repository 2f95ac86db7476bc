"""Certificates changed in one or two places, as a forger or an accident would change them.

A `mutant` is a certificate of `claims.MAKERS` with a change in its structure, its numbers, its
trees or its robot. `python -m engine_support.mutations 100000` (in this folder's parent, with the
package on the path) gives as many mutants to checker and oracle, and judges by samples what they
accept.
"""

from __future__ import annotations

import copy
import json
import random
import re
import sys
from collections import Counter
from collections.abc import Callable
from typing import Any

from cspace import check
from engine_support import brute_force, second_checker
from engine_support.certificates import rehash
from engine_support.claims import MAKERS, original

Json = Any
Change = Callable[[random.Random, Json], None]


def mutant(seed: int) -> Json:
    """Return an original with one to three changes; the same for the same seed."""
    rng = random.Random(seed)
    data = original(rng.choice([*MAKERS]))
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        rng.choice(CHANGES)(rng, data)
    return data


def places(data: Json, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths to everything inside, the robot's text as a whole."""
    found = [path] if path else []
    rows = dict(enumerate(data)) if isinstance(data, list) else data
    for key, value in rows.items() if isinstance(rows, dict) else ():
        found += places(value, (*path, key))
    return found


def parent(data: Json, path: tuple[Any, ...]) -> Json:
    for step in path[:-1]:
        data = data[step]
    return data


def where(
    wanted: Callable[[Json], object], change: Callable[[random.Random, Json], Json]
) -> Change:
    """Return a change of one of the values that are of some sort."""

    def apply(rng: random.Random, data: Json) -> None:
        paths = [p for p in places(data) if p[0] not in ("robot", "sha256")]
        paths = [p for p in paths if wanted(parent(data, p)[p[-1]])]
        if paths:
            path = rng.choice(paths)
            row = parent(data, path)
            row[path[-1]] = change(rng, row[path[-1]])
            if path[0] == "parts":
                rehash(data)

    return apply


def is_decimal(value: Json) -> bool:
    return isinstance(value, str) and bool(re.fullmatch(r"-?[0-9]+([.][0-9]+)?(e-?[0-9])?", value))


def is_tree(value: Json) -> bool:
    return isinstance(value, str) and bool(re.fullmatch(r"[a-z0-9.]*[.]", value))


def moved(rng: random.Random, value: str) -> str:
    """Change a number a little, much, or not at all but for the way it is written."""
    x = float(value)
    tails = (" ", "\n", "_", "e", "e1", "0", "e-1", "E99", "e999", ".", "/2")
    return rng.choice(
        [
            f"{x + rng.choice((-1, 1)) * 10.0 ** rng.randint(-6, 3):.6f}",
            f"{x * rng.uniform(-2, 2):.6f}",
            f"{-x:.6f}",
            value + rng.choice(tails),
            rng.choice((" ", "+", "0", "-", "\u0663")) + value,
            "0",
        ]
    )


def cut(rng: random.Random, tree: str) -> str:
    """Change a letter, leave one out, add one, replace a leaf, or replace the tree."""
    i, letter = rng.randrange(len(tree)), rng.choice("abcdefgz.0123")
    leaf = rng.choice((".", "0.", "1.", "2.", "7.", f"a{letter}.{letter}."))
    leaves = [*re.finditer("[0-9]*[.]", tree)]
    spot = rng.choice(leaves) if leaves else re.match("", tree)
    found = [
        tree[:i] + letter + tree[i + 1 :],
        tree[:i] + tree[i + 1 :],
        tree[:i] + letter + tree[i:],
    ]
    found += [tree[: spot.start()] + leaf + tree[spot.end() :]] * 3 if spot else []
    return rng.choice([*found, ".", "0.", "a..", "a0.1.", "b..", letter])


def relisted(rng: random.Random, items: list[Json]) -> list[Json]:
    """Leave an item out, repeat it, exchange two, or turn the list round."""
    if not items:
        return [rng.choice(("0", 0, ["0", "0"]))]
    i, j = rng.randrange(len(items)), rng.randrange(len(items))
    swapped = [*items]
    swapped[i], swapped[j] = items[j], items[i]
    repeated = [*items[:i], copy.deepcopy(items[j]), *items[i:]]
    turned = [*items[i:], *items[:i]]
    shorter = [items[:i] + items[i + 1 :], items[:i]]
    return rng.choice([*shorter, repeated, swapped, items[::-1], turned])


def other(rng: random.Random, _: Json) -> Json:
    """Choose a value of any type."""
    values = ["", "0", ".", "a..", 0, 1, -1, 1.5, True, None, [], {}, ["0"], [["0", "0"]], "1e99"]
    return copy.deepcopy(rng.choice(values))


WORDS = [
    (("claim", "set"), ("box", "path", "polygon", "no path")),
    (("claim", "margin"), ("0", "0.001", "0.1", "10", "1e99")),
    (("claim", "joints", 0), ("moves", "held", "any")),
    (("claim", "joints", 1), ("moves", "held", "any")),
    (("witness", "limit"), ("q1.lower", "q1.upper", "q2.lower", "floor")),
    (("witness", "place", "inside"), (["0", "0"], ["0.1", "0"], ["0", "0.03"], ["1", "1"])),
    (("schema",), ("qbound/certificate/5", 6)),
    (("sha256",), ("0" * 64, "")),
]


def another_word(rng: random.Random, data: Json) -> None:
    """Replace a word by another of its sort."""
    path, words = rng.choice(WORDS)
    try:
        row = parent(data, path)
        row[path[-1]] = copy.deepcopy(rng.choice([row[path[-1]], *words]))
    except (LookupError, TypeError):
        return


def drop_or_rename(rng: random.Random, data: Json) -> None:
    """Leave a key out, add one, or give one's value to another name."""
    names = ("claim", "proof", "witness", "parts")
    tables = [data, *(data[name] for name in names if isinstance(data.get(name), dict))]
    table = rng.choice(tables)
    keys = sorted(key for key in table if key not in ("robot", "claim"))
    if keys and rng.random() < 0.6:
        value = table.pop(rng.choice(keys))
        if rng.random() < 0.5:
            table[rng.choice([*keys, "at", "cell", "limit", "triangles", "proof"])] = value
    else:
        table[rng.choice(("extra", "at", "cell", "triangles", "joints", "limit"))] = other(
            rng, None
        )


PAIRS = [
    *(("revolute", "prismatic"), ('"pair"', '"half-space"'), ('"deg"', '"rad"'), ("crank", "rpy")),
    *(("clearance", "offset"), ("radius = ", "radius = -"), ("clearance = ", "clearance = -")),
    *(("limits", "rpy"), ("capsule", "disc"), ('"all"', '"none"'), ("used = false", "")),
    *(("parallelogram", "revolute"), ("[0, 0, 1]", "[0, 0, -1]"), ("[0, 1, 0]", "[1, 0, 0]")),
]
ADDED = [
    *("x = 1", "home.q1 = 0", "used = false", "radius = 0.5"),
    *("clearance = 0", 'at = ["1", "2", "3"]', "limits = [-90, 90]", "limits = [-2, 2]"),
    *("rpy = [0, 90, 0]", "rpy = [0, 0, 30]"),
]


def in_robot(rng: random.Random, data: Json) -> None:
    """Change the robot's text, and its hash with it."""
    robot = data.get("robot")
    if not isinstance(robot, str):
        return
    kind, lines = rng.randrange(5), robot.split("\n")
    if kind < 2:  # a number
        spot = rng.choice([*re.finditer(r"(?<![\w\"])-?[0-9]+(\.[0-9]+)?", robot), None])
        if spot:
            robot = robot[: spot.start()] + moved(rng, spot[0]) + robot[spot.end() :]
    elif kind == 2:  # a line
        i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
        lines[i : i + 1] = rng.choice(([], [lines[i]] * 2, [lines[j]], [lines[i], lines[j]]))
        robot = "\n".join(lines)
    elif kind == 3:  # a word for another of its sort
        a, b = rng.choice(PAIRS)
        robot = robot.replace(*((a, b) if a in robot else (b, a)), rng.choice((1, -1)))
    else:
        ends = [*re.finditer(" }", robot)] if rng.random() < 0.8 else []
        spot = rng.choice(ends).start() if ends else 0
        robot = (
            robot[:spot]
            + (", " if ends else "")
            + rng.choice(ADDED)
            + "\n" * (not ends)
            + robot[spot:]
        )
    data["robot"] = robot
    rehash(data)


CHANGES: tuple[Change, ...] = (
    *[where(is_decimal, moved)] * 3,
    *[where(is_tree, cut)] * 3,
    *[where(lambda value: isinstance(value, list), relisted)] * 2,
    where(lambda value: type(value) is int, lambda rng, _: rng.randint(-2, 9)),
    where(lambda value: type(value) is int, lambda rng, x: x + rng.choice((-1, 1))),
    where(lambda _: True, other),
    another_word,
    drop_or_rename,
    *[in_robot] * 3,
)


# --- what checker and oracle say ------------------------------------------------------------------

FINER = (
    r"\('not proved|fails on a leaf|not violated all over a leaf|not violated there|has no range"
)
LONGER = "work|of more than|more than 300|follows another word|'-0'"


def answers(data: Json) -> tuple[str, str]:
    """Return what checker and oracle say: a verdict, or the refusal."""
    text, found = json.dumps(data), []
    for verify in (lambda t: ("proved", "refuted")[check.check(t).refuted], second_checker.verify):
        try:
            found.append(str(verify(text)))
        except ValueError as refusal:
            found.append(f"refused: {refusal}")
    return found[0], found[1]


def fault_of(data: Json, seed: int) -> str:
    """Return why the answers on a mutant are at fault; nothing if they are not.

    They may differ where one of them is the finer one: the oracle cuts leaves where its bound
    fails, and each of them has a bound that sees further on some leaves. Beside a margin of 1e99 a
    slide has no range for the checker.
    """
    one, other_one = answers(data)
    taken = [answer for answer in (one, other_one) if not answer.startswith("refused")]
    if taken and not brute_force.tells_the_truth(data, seed):
        return f"false: {one} | {other_one}"
    if one != other_one and len(taken) == 1 and not re.search(f"{FINER}|{LONGER}", one + other_one):
        return f"differ: {one} | {other_one}"
    return f"differ: {one} | {other_one}" if len({*taken}) == 2 else ""


def main(count: int, first: int = 0) -> None:
    """Print what is found among many mutants."""
    told = Counter[str]()
    for seed in range(first, first + count):
        data = mutant(seed)
        fault = fault_of(data, seed)
        told["fault" if fault else answers(data)[0].partition(":")[0]] += 1
        if fault:
            sys.stdout.write(f"{seed}: {fault}\n")
    sys.stdout.write(f"{dict(told)}\n")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
