"""Certificates changed in one or two places, as a forger or an accident would change them.

`originals` are true certificates of every kind of set, of both grammars and both verdicts; a
`mutant` is one of them with a change in its structure, its numbers, its trees or its robot.
"""

import copy
import hashlib
import json
import random
import re
from collections.abc import Callable
from functools import cache
from typing import Any

from qbound.model.robotfile import robot_text
from support.certificates import certificate, text
from support.robot_files import robot_file

Json = Any

HOMES = {
    "minervabot-v2": ((0, 0), (8, 8)),
    "pp-portal": ((150, 350), (20, 20)),
    "pr-gantry-arm": ((0.9, 0), (0.04, 4)),
    "rp-telescopic-boom": ((-35, 0.4), (4, 0.04)),
    "two-joint-arm-with-walls": ((20, 60), (1, 1)),
}
"""Packaged robots: their homes and sizes about them that are safe, in their units."""


@cache
def originals() -> tuple[str, ...]:
    """Return small certificates: proofs about home of each robot, and refutations."""
    found = []
    for name, (home, size) in HOMES.items():
        robot, _ = robot_text(name)
        for grammar in (1, 2):
            for statement in sets_about(home, size):
                found.append(certificate(robot, statement, grammar))
                found.append(refuted(robot, statement, grammar))
    three = robot_file(4, 3, "revolute").replace("clearance = ", "clearance = 0.0001 # ")
    three = re.sub(r"offset = -?[0-9.]+", "offset = -40", three)
    for grammar in (1, 2):
        found.append(certificate(three, box(["0", "0", "0"], ["9", "2.5", "0"]), grammar))
        found.append(certificate(three, box(["0", "0", "0"], ["2", "2", "2"]), grammar))
    return tuple(found)


def box(low: list[str], high: list[str]) -> Json:
    return {"set": "box", "margin": "0", "points": [[low, high]]}


Pair = tuple[float, float]


def sets_about(home: Pair, size: Pair) -> list[Json]:
    """Return a box, a path and two polygons, one of them with a hole, around a place."""
    (x, y), (width, height) = home, size

    def at(*places: Pair) -> list[list[str]]:
        return [[f"{x + width * a:.6f}", f"{y + height * b:.6f}"] for a, b in places]

    square = at((0, 0), (2, 0), (2, 1), (0, 1))
    outer, hole = at((0, 0), (3, 0), (3, 3), (0, 3)), at((1, 1), (1, 2), (2, 2), (2, 1))
    around = [
        [0, 1, 7],
        [0, 7, 4],
        [1, 2, 6],
        [1, 6, 7],
        [2, 3, 5],
        [2, 5, 6],
        [3, 0, 4],
        [3, 4, 5],
    ]
    return [
        box(*at((0, 0), (2, 1))),
        {
            "set": "path",
            "margin": "0.001",
            "points": [at((0, 0), (1, 1), (2, 0)), at((0, 1), (2, 1))],
        },
        polygon([square], [[0, 1, 2], [0, 2, 3]]),
        polygon([outer, hole], around),
    ]


def polygon(points: Json, triangles: Json) -> Json:
    return {"set": "polygon", "margin": "0", "points": points, "triangles": triangles}


def refuted(robot: str, statement: Json, grammar: int) -> str:
    """Ask for a margin that nothing keeps, and name the first boundary in use."""
    statement = statement | {"margin": "100000"}
    corners = 3 if statement["set"] == "polygon" else 2
    corners = 3 if statement["set"] == "box" else corners
    witness = {"cell": 0, "weights": ["0.5", "0.25", "0.25"] if corners == 3 else ["0.5", "0.5"]}
    if statement["set"] == "box" and grammar == 2:
        witness = {"at": statement["points"][0][0]}
    name = re.search(r'\[\[boundary\]\]\s*name = "([^"]*)"', robot)[1]
    return text(robot, statement, grammar, verdict="refuted", boundary=name, **witness)


# --- changes --------------------------------------------------------------------------------------

Change = Callable[[random.Random, Json], None]


def mutant(seed: int) -> str:
    """Return an original with one to three changes; the same for the same seed."""
    rng = random.Random(seed)
    data = json.loads(rng.choice(originals()))
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        rng.choice(CHANGES)(rng, data)
    return json.dumps(data)


def places(data: Json, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the paths to everything inside, the robot's text as a whole."""
    found = [path] if path else []
    items = (
        data.items()
        if isinstance(data, dict)
        else enumerate(data)
        if isinstance(data, list)
        else ()
    )
    for key, value in items:
        found += places(value, (*path, key))
    return found


def parent(data: Json, path: tuple[Any, ...]) -> Json:
    for step in path[:-1]:
        data = data[step]
    return data


def chosen(
    rng: random.Random, data: Json, wanted: Callable[[Json], bool]
) -> tuple[Json, Any] | None:
    """Choose a place whose value is of some sort: the container and the key."""
    paths = [p for p in places(data) if p[0] not in ("robot", "sha256")]
    paths = [p for p in paths if wanted(parent(data, p)[p[-1]])]
    if not paths:
        return None
    path = rng.choice(paths)
    return parent(data, path), path[-1]


def change_where(
    wanted: Callable[[Json], bool], change: Callable[[random.Random, Json], Json]
) -> Change:
    def apply(rng: random.Random, data: Json) -> None:
        place = chosen(rng, data, wanted)
        if place:
            container, key = place
            container[key] = change(rng, container[key])

    return apply


def is_decimal(value: Json) -> bool:
    return (
        isinstance(value, str)
        and re.fullmatch(r"-?[0-9]+([.][0-9]+)?(e-?[0-9])?", value) is not None
    )


def is_tree(value: Json) -> bool:
    return isinstance(value, str) and re.fullmatch(r"[a-z.]*[.]", value) is not None


def is_list(value: Json) -> bool:
    return isinstance(value, list)


def is_index(value: Json) -> bool:
    return type(value) is int


def moved(rng: random.Random, value: str) -> str:
    """Change a number a little, much, or not at all but for the way it is written."""
    x = float(value)
    return rng.choice(
        [
            f"{x + rng.choice((-1, 1)) * 10.0 ** rng.randint(-6, 3):.6f}",
            f"{x * rng.uniform(-2, 2):.6f}",
            f"{-x:.6f}",
            value + rng.choice((" ", "\n", "_", "e", "e1", "0", "e-1", "E99", "e999", ".", "/2")),
            rng.choice((" ", "+", "0", "-", "\u0663")) + value,
            "0",
        ]
    )


def other(rng: random.Random, _: Json) -> Json:
    """Choose a value of any type."""
    values = ["", "0", ".", "a..", 0, 1, -1, 1.5, True, None, [], {}, ["0"], [["0", "0"]], "1e99"]
    return copy.deepcopy(rng.choice(values))


def cut(rng: random.Random, tree: str) -> str:
    """Change a letter, leave one out, add one, or replace the tree."""
    i, letter = rng.randrange(len(tree)), rng.choice("abcdefz.")
    return rng.choice([tree[:i] + letter + tree[i + 1 :], tree[:i] + tree[i + 1 :],
                       tree[:i] + letter + tree[i:], ".", "a..", "b..", letter])  # fmt: skip


def relisted(rng: random.Random, items: list[Json]) -> list[Json]:
    """Leave an item out, repeat it, exchange two, or turn the list round."""
    if not items:
        return [rng.choice(("0", 0, ["0", "0"]))]
    i, j = rng.randrange(len(items)), rng.randrange(len(items))
    swapped = list(items)
    swapped[i], swapped[j] = items[j], items[i]
    repeated = [*items[:i], copy.deepcopy(items[j]), *items[i:]]
    turned = [*items[i:], *items[:i]]
    return rng.choice(
        [items[:i] + items[i + 1 :], repeated, swapped, items[::-1], turned, items[:i]]
    )


def drop_or_rename(rng: random.Random, data: Json) -> None:
    """Leave a key out, add one, or give one's value to another name."""
    tables = [data, data["statement"] if isinstance(data.get("statement"), dict) else data]
    tables += [data["proof"]] if isinstance(data.get("proof"), dict) else []
    table = rng.choice(tables)
    keys = sorted(key for key in table if key not in ("robot", "statement"))
    if keys and rng.random() < 0.6:
        value = table.pop(rng.choice(keys))
        if rng.random() < 0.5:
            table[rng.choice([*keys, "B1", "extra", "at", "triangles"])] = value
    else:
        table[rng.choice(("extra", "at", "cell", "triangles", "B1", "note"))] = other(rng, None)


def another_head(rng: random.Random, data: Json) -> None:
    key, values = rng.choice(
        [
            (
                "schema",
                [
                    "qbound/certificate/1",
                    "qbound/certificate/2",
                    "qbound/certificate/3",
                    "qbound/certificate/4",
                    2,
                ],
            ),
            ("verdict", ["proved", "refuted", "undecided"]),
            ("sha256", ["0" * 64, ""]),
            ("boundary", ["B1", "B7", "q1.lower", "q1.upper", "lift.lower", "nothing"]),
        ]
    )
    if key in data:
        data[key] = rng.choice(values)


def another_set(rng: random.Random, data: Json) -> None:
    if isinstance(data.get("statement"), dict):
        data["statement"]["set"] = rng.choice(("box", "path", "polygon"))


def in_robot(rng: random.Random, data: Json) -> None:
    """Change the robot's text, and its hash with it."""
    robot = data.get("robot")
    if not isinstance(robot, str):
        return
    kind = rng.randrange(4)
    if kind == 0:  # a number
        spots = [*re.finditer(r"-?[0-9]+\.[0-9]+", robot)]
        if not spots:
            return
        spot = rng.choice(spots)
        robot = robot[: spot.start()] + moved(rng, spot[0]) + robot[spot.end() :]
    elif kind == 1:  # a line
        lines = robot.split("\n")
        i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
        lines[i : i + 1] = rng.choice(([], [lines[i]] * 2, [lines[j]], [lines[i], lines[j]]))
        robot = "\n".join(lines)
    elif kind == 2:  # a word for another of its sort
        pairs = [("revolute", "prismatic"), ('"pair"', '"half-space"'), ('"deg"', '"rad"'),
                 ("false", "true"), ("used = false", ""), ("clearance", "offset"),
                 ("radius = ", "radius = -"), ("clearance = ", "clearance = -"),
                 ("limits", "rpy")]  # fmt: skip
        a, b = rng.choice(pairs)
        robot = robot.replace(*((a, b) if a in robot else (b, a)), rng.choice((1, -1)))
    else:
        added = ["x = 1", "[[body]]", "[extra]", "home.q1 = 0", "used = false", "radius = 0.5",
                 'at = ["1", "2", "3"]', "limits = [-90, 90]", "rpy = [0, 90, 0]",
                 "clearance = 0"]  # fmt: skip
        lines = robot.split("\n")
        lines.insert(rng.randrange(len(lines)), rng.choice(added))
        robot = "\n".join(lines)
    data["robot"] = robot
    data["sha256"] = hashlib.sha256(robot.encode()).hexdigest()


CHANGES: tuple[Change, ...] = (
    change_where(is_decimal, moved),
    change_where(is_decimal, moved),
    change_where(is_tree, cut),
    change_where(is_tree, cut),
    change_where(is_list, relisted),
    change_where(is_list, relisted),
    change_where(is_index, lambda rng, _: rng.randint(-2, 9)),
    change_where(lambda _: True, other),
    drop_or_rename,
    another_head,
    another_set,
    in_robot,
    in_robot,
    in_robot,
)
