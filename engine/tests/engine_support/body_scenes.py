"""Robot files of bodies in decimals: any number of them by seed, and exact copies of each.

A scene is a text, as a user would write it, of decimal numbers of a few digits. Of every 20 seeds
12 are ordinary, 5 in whole numbers and right angles, 3 on purpose in a tie; every fiftieth has 100
obstacles. Copies are computed in decimals: not one digit is rounded but those of a home pose.
"""

import tomllib
from collections.abc import Callable
from decimal import Decimal, localcontext
from random import Random
from typing import Any

import shapely

from cspace import Robot
from cspace.model.robotfile import parse_robot

Table = dict[str, Any]
Flat = tuple[Decimal, Decimal]
Turn = tuple[Decimal, Decimal]

PLANES = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
QUARTER: Turn = Decimal(0), Decimal(1)
PYTHAGORAS: Turn = Decimal("0.6"), Decimal("0.8")
ANGLE_OF_PYTHAGORAS = {"deg": Decimal("53.13010235415598"), "rad": Decimal("0.9272952180016122")}
QUARTER_TURN = {"deg": Decimal(90), "rad": Decimal("1.5707963267948966")}
TRIPLES = [(3, 4, 5), (4, 3, 5), (5, 12, 13), (12, 5, 13), (8, 6, 10), (-3, 4, 5), (4, -3, 5)]


# --- texts and tables -----------------------------------------------------------------------------


def read(text: str) -> Table:
    """The table of a robot file, all its numbers decimals."""

    def exact(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: exact(x) if key != "schema" else x for key, x in value.items()}
        if isinstance(value, list):
            return [exact(x) for x in value]
        return Decimal(value) if type(value) is int else value

    return exact(tomllib.loads(text, parse_float=Decimal))


def written(table: Table) -> str:
    """The text of a table, decimals digit by digit."""
    lists = {k: table[k] for k in ("joint", "point", "body", "obstacle", "boundary") if k in table}
    lines = [f"{key} = {_value(x)}" for key, x in table.items() if key not in lists]
    for kind, rows in lists.items():
        for row in rows:
            lines += [f"\n[[{kind}]]", *(f"{key} = {_value(x)}" for key, x in row.items())]
    return "\n".join(lines) + "\n"


def _value(x: Any) -> str:
    if isinstance(x, dict):
        return "{ " + ", ".join(f"{key} = {_value(each)}" for key, each in x.items()) + " }"
    if isinstance(x, list | tuple):
        return "[" + ", ".join(map(_value, x)) + "]"
    return f'"{x}"' if isinstance(x, str) else str(x)


# --- exact copies ---------------------------------------------------------------------------------


def shifted(text: str, places: int) -> str:
    """All lengths times a power of ten."""
    table = read(text)

    def longer(x: Decimal) -> Decimal:
        return x.scaleb(places)

    _change(table, lambda p: (longer(p[0]), longer(p[1])), longer, directions=False)
    slides = [joint for joint in table["joint"] if joint["type"] == "prismatic"]
    for joint in slides:
        joint["limits"] = [longer(x) for x in joint["limits"]]
        table["home"][joint["name"]] = longer(table["home"][joint["name"]])
    return written(table)


def mirrored(text: str) -> str:
    """The second coordinate of all frames negated.

    Of joints that turn the first keeps its axis and turns the other way, its limits and home
    negated; the second has the same values about the opposite axis.
    """
    table = read(text)
    _change(table, lambda p: (p[0], -p[1]))
    for j, joint in enumerate(table["joint"]):
        if "rpy" in joint:
            joint["rpy"] = [-x for x in joint["rpy"]]
        if joint["type"] == "prismatic":
            continue
        if j:
            joint["axis"] = [-x for x in joint["axis"]]
            continue
        table["home"][joint["name"]] *= -1
        if "limits" in joint:
            joint["limits"] = [-x for x in reversed(joint["limits"])]
    return written(table)


def turned(text: str, turn: Turn = PYTHAGORAS) -> str:
    """All places turned by an angle of that cosine and sine.

    Where joint 1 turns all the way round only what stands still is turned, and the region moves
    along joint 1; else the coordinates of every frame are turned alike, and it stays.
    """
    table, (c, s) = read(text), turn
    first = table["joint"][0]
    free = first["type"] == "revolute" and "limits" not in first
    frames = {first["parent"]} if free else None
    _change(table, lambda p: (c * p[0] - s * p[1], s * p[0] + c * p[1]), frames=frames)
    if free:
        angle = (QUARTER_TURN if turn == QUARTER else ANGLE_OF_PYTHAGORAS)[table["angle_unit"]]
        table["home"][first["name"]] += angle * _sense(table)
    return written(table)


def turned90(text: str) -> str:
    """All places turned by a right angle, as by `turned`."""
    return turned(text, QUARTER)


def copies(text: str, powers: tuple[int, ...] = (3, -3)) -> dict[str, tuple[str, int]]:
    """Every copy by its name, and by which power of ten its lengths are longer."""
    return {f"times 1e{places}": (shifted(text, places), places) for places in powers} | {
        "mirrored": (mirrored(text), 0),
        "turned by 90": (turned90(text), 0),
        "turned by 0.6, 0.8": (turned(text), 0),
    }


def plane_of(table: Table) -> tuple[int, int]:
    """Which two coordinates are those of the plane: the axes of turns, or the slides, tell.

    Of the planes along one line they are the first that the library takes.
    """
    axes = [(joint["axis"], joint["type"] == "revolute") for joint in table["joint"]]
    across = next((axis for axis, turns in axes if turns), None)
    if across is not None:
        (normal,) = (k for k in range(3) if across[k])
    else:
        free = [k for k in range(3) if not any(axis[k] for axis, _ in axes)]
        normal = 1 if 1 in free else free[-1]
    one, other = (k for k in range(3) if k != normal)
    return one, other


def _sense(table: Table) -> int:
    """+1 where the first joint turns from the plane's first axis to the second, else -1."""
    one, other = plane_of(table)
    along = table["joint"][0]["axis"][3 - one - other]
    return (1 if along > 0 else -1) * (-1 if (one, other) == (0, 2) else 1)


def _change(
    table: Table,
    place: Callable[[Flat], Flat],
    length: Callable[[Decimal], Decimal] = lambda x: x,
    *,
    directions: bool = True,
    frames: set[str] | None = None,
) -> None:
    """Change every place, length and direction of a table; of some frames only, if named."""
    one, other = plane_of(table)
    base = table["joint"][0]["parent"]

    def space(p: list[Decimal], scale: bool = True) -> list[Decimal]:
        if len(p) == 2:
            return list(place((p[0], p[1])))
        found = list(p)
        found[one], found[other] = place((p[one], p[other]))
        across = 3 - one - other
        found[across] = length(p[across]) if scale else p[across]
        return found

    for joint in table["joint"]:
        if frames is None or joint["parent"] in frames:
            joint["origin"] = space(joint["origin"])
            if joint["type"] == "prismatic" and directions:
                joint["axis"] = space(joint["axis"], scale=False)
    bodies = [*table.get("body", []), *table.get("obstacle", [])]
    for row in (*table["point"], *bodies):
        if frames is not None and row.get("frame", base) not in frames:
            continue
        if "polygon" in row:
            row["polygon"] = [space(p) for p in row["polygon"]]
        for shape in (row, row.get("capsule", {}), row.get("disc", {})):
            shape.update({key: space(shape[key]) for key in ("at", "from", "to") if key in shape})
    round_ones = [row[key] for row in bodies for key in ("capsule", "disc") if key in row]
    for row in (table, *table["point"], *round_ones, *table.get("boundary", [])):
        lengths = [key for key in ("radius", "offset", "clearance") if key in row]
        row.update({key: length(row[key]) for key in lengths})
        if "normal" in row and directions:
            row["normal"] = space(row["normal"], scale=False)


# --- scenes ---------------------------------------------------------------------------------------


def scene(seed: int) -> str:
    """The text of the robot file of a seed."""
    rng = Random(1_000_003 * seed + 17)
    place = seed % 20
    make = _ordinary if place < 12 else _whole if place < 17 else _nasty
    many = seed % 50 == 49
    if many and make is _nasty:
        make = _whole
    draw = _Draw(rng, rng.choices(["RR", "RP", "PR", "PP"], [4, 2, 2, 2])[0])
    table = make(draw, 100 if many else rng.choice([1, 1, 2, 2, 3, 4, 5, 6, 8, 10, 15, 30]))
    names = {_ordinary: "ordinary", _whole: "whole", _nasty: "nasty"}
    table["name"] = f"{names[make]} {seed} {draw.kinds}"
    text = written(table)
    if rng.random() < 0.15:
        text = shifted(text, rng.choice([-9, -6, -4, -3, -2, 2, 3, 4, 6, 9]))
    return text


def ordinary(seed: int, kinds: str = "RR", plane: str = "xz", obstacles: int = 3) -> str:
    """The text of an ordinary scene of two joints, R for a turn and P for a slide."""
    draw = _Draw(Random(seed), kinds)
    draw.plane, draw.angle_unit = plane, "deg"
    return written(_ordinary(draw, obstacles) | {"name": f"ordinary {seed} {kinds}"})


def whole(seed: int, kinds: str, plane: str, obstacles: int, unit: str) -> str:
    """The text of a scene in whole numbers, of one to three joints."""
    draw = _Draw(Random(seed), kinds)
    draw.plane, draw.angle_unit = plane, unit
    return written(_whole(draw, obstacles) | {"name": f"whole {seed} {kinds}"})


def robot(text: str) -> Robot:
    """The robot of the doubles of a text."""
    return parse_robot(tomllib.loads(text))


class _Draw:
    """Numbers and shapes at random, in one plane."""

    def __init__(self, rng: Random, kinds: str) -> None:
        self.rng, self.kinds, self.last = rng, kinds, f"L{len(kinds)}"
        self.plane = rng.choices(list(PLANES), [7, 2, 1])[0]
        self.angle_unit = "deg" if rng.random() < 0.8 else "rad"
        self.sharp = True

    def number(self, low: float, high: float, digits: int = 3) -> Decimal:
        """A decimal of some digits behind the point."""
        scale = 10**digits
        return Decimal(self.rng.randint(round(low * scale), round(high * scale))).scaleb(-digits)

    def chance(self, part: float) -> bool:
        return self.rng.random() < part

    def space(self, u: Any, v: Any, across: Any = 0) -> list[Decimal]:
        """A place or a direction of the plane in space."""
        found = [Decimal(across)] * 3
        one, other = PLANES[self.plane]
        found[one], found[other] = Decimal(u), Decimal(v)
        return found

    def table(self, joints: list[Table], home: list[Any]) -> Table:
        """A robot without bodies: a tool, and collisions of all that is to come."""
        return {
            "schema": 1,
            "name": "",
            "length_unit": self.rng.choice(["m", "cm", "mm"]),
            "angle_unit": self.angle_unit,
            "home": {f"q{j + 1}": Decimal(x) for j, x in enumerate(home)},
            "tool": "tip",
            "collisions": "all",
            "joint": joints,
            "point": [{"name": "tip", "frame": self.last, "at": self.space(1, 0)}],
            "body": [],
            "obstacle": [],
        }

    def joint(self, j: int, origin: Any, limits: Any = None, slide: Any = None) -> Table:
        """Joint j: without a slide's direction it turns, either way."""
        axis = self.space(*slide) if slide else self.space(0, 0, self.rng.choice([-1, 1]))
        row = {
            "name": f"q{j + 1}",
            "type": "prismatic" if slide else "revolute",
            "parent": f"L{j}" if j else "base",
            "frame": f"L{j + 1}",
            "origin": self.space(*origin),
            "axis": axis,
        }
        return row | ({"limits": [Decimal(x) for x in limits]} if limits else {})

    def turns(self, degrees: Any) -> list[Decimal] | None:
        """Limits of a turn, or none."""
        if degrees is None:
            return None
        scale = Decimal(1) if self.angle_unit == "deg" else Decimal("0.017453292519943295")
        with localcontext(prec=16):
            return [x * scale for x in map(Decimal, degrees)]


def disc(u: Any, v: Any, radius: Any) -> Table:
    return {"disc": {"at": [Decimal(u), Decimal(v)], "radius": Decimal(radius)}}


def capsule(start: Any, end: Any, radius: Any) -> Table:
    ends = {"from": [Decimal(x) for x in start], "to": [Decimal(x) for x in end]}
    return {"capsule": ends | {"radius": Decimal(radius)}}


def polygon(*corners: Any) -> Table:
    return {"polygon": [[Decimal(u), Decimal(v)] for u, v in corners]}


def box(u: Any, v: Any, width: Any, height: Any) -> Table:
    """A rectangle from its lowest left corner."""
    u, v, w, h = map(Decimal, (u, v, width, height))
    return polygon((u, v), (u + w, v), (u + w, v + h), (u, v + h))


def _named(rows: list[Table], name: str = "o") -> list[Table]:
    return [{"name": f"{name}{i}"} | row for i, row in enumerate(rows)]


# --- ordinary scenes ------------------------------------------------------------------------------


def _ordinary(draw: _Draw, count: int) -> Table:
    """Links and obstacles of all shapes at random places, walls, clearances, spheres."""
    number = draw.number
    one = number(0.4, 1.2)
    joints, home = [], []
    for j, kind in enumerate(draw.kinds):
        origin = (number(-0.1, 0.1), number(-0.1, 0.1)) if j == 0 else (one, 0)
        if j == 1 and draw.chance(0.3):
            origin = (one, number(-0.2, 0.2))
        if kind == "R":
            start = number(-200, 60, 1)
            free = draw.chance(0.6)
            limits = None if free else draw.turns([start, start + number(60, 340, 1)])
            joints.append(draw.joint(j, origin, limits))
        else:
            slide = (number(-1, 1, 2), number(0.05, 1, 2))
            if j == 1 and draw.kinds == "PP":  # never along the first
                first = joints[0]["axis"]
                a, b = (first[k] for k in PLANES[draw.plane])
                slide = (-b, a) if draw.chance(0.5) else (a - b, a + b)
            limits = [-number(0.2, 1), number(0.3, 1.2)]
            joints.append(draw.joint(j, origin, limits, slide))
        mean = sum(joints[j].get("limits", [Decimal(0)])) / 2
        home.append(mean.quantize(Decimal("0.001")))
        if draw.chance(0.15):
            joints[j]["rpy"] = [x * number(-90, 90, 0) for x in _across(draw)]
            if draw.angle_unit == "rad":
                joints[j]["rpy"] = [x.scaleb(-2) for x in joints[j]["rpy"]]
    table = draw.table(joints, home)
    two = number(0.3, 1.0)
    table["point"][0]["at"] = draw.space(two, 0)
    table["body"] = _links(draw, one, two)
    size = 0.06 if count > 50 else 0.15 if count > 12 else 0.4
    table["obstacle"] = _named([_shape(draw, *_around(draw, 0.4, 2.2), size) for _ in range(count)])
    _walls(draw, table)
    _spheres(draw, table)
    if draw.chance(0.3):
        table["clearance"] = number(0.005, 0.05)
    table["allowed"] = _neighbours(table)
    return table


def _across(draw: _Draw) -> list[Decimal]:
    """The plane's normal."""
    return [Decimal(int(k not in PLANES[draw.plane])) for k in range(3)]


def _around(draw: _Draw, low: float, high: float) -> Flat:
    """A place at a distance from the base, in a box or ring at random."""
    while True:
        u, v = draw.number(-high, high), draw.number(-high, high)
        if low <= float(u * u + v * v) ** 0.5 <= high:
            return u, v


def _links(draw: _Draw, one: Decimal, two: Decimal) -> list[Table]:
    rows = []
    if draw.chance(0.75):
        rows.append({"frame": "L1", "name": "arm"} | _link(draw, one))
    rows.append({"frame": draw.last, "name": "fore"} | _link(draw, two))
    if draw.chance(0.2):
        extra = _shape(draw, two, draw.number(-0.2, 0.2), 0.25)
        rows.append({"frame": draw.last, "name": "hand"} | extra)
    if draw.chance(0.2):
        foot = _shape(draw, draw.number(-0.5, 0.5), draw.number(-0.8, -0.3), 0.25)
        rows.append({"frame": "base", "name": "foot"} | foot)
    return rows


def _link(draw: _Draw, length: Decimal) -> Table:
    """A capsule, a convex polygon, an L, a U or a disc at the end."""
    number, w = draw.number, draw.number(0.02, 0.12)
    which = draw.rng.randrange(6)
    end, back = length, -number(0, 0.1)
    if which in (0, 1):
        return capsule((back, 0), (end, number(-0.05, 0.05)), w)
    if which == 2:
        return polygon((back, -w), (end, -w / 2), (end + w, 0), (end, w / 2), (back, w))
    if which == 3:
        h = w + number(0.05, 0.3)
        return polygon((back, -w), (end, -w), (end, h), (end - w, h), (end - w, w), (back, w))
    if which == 4:
        h = w + number(0.1, 0.3)
        return polygon(
            (0, -w), (end, -w), (end, h), (end - w, h), (end - w, w), (w, w), (w, h), (0, h)
        )
    return disc(end, number(-0.1, 0.1), number(0.05, 0.3))


def _shape(draw: _Draw, u: Decimal, v: Decimal, size: float) -> Table:
    """A disc, a capsule, a convex polygon or a star about a place."""
    which = draw.rng.randrange(5)
    if which == 0:
        return disc(u, v, draw.number(0.1 * size, 0.8 * size, 4))
    if which == 1:
        end = u + draw.number(-size, size), v + draw.number(0.1 * size, size)
        return capsule((u, v), end, draw.number(0.1 * size, 0.3 * size, 4))
    if which == 2:
        return box(u, v, draw.number(0.3 * size, size), draw.number(0.3 * size, size))
    while True:
        ring = [
            (u + draw.number(-size, size), v + draw.number(-size, size))
            for _ in range(draw.rng.choice([3, 4, 5, 6]))
        ]
        if which == 3:
            hull = shapely.MultiPoint([[float(x) for x in p] for p in ring]).convex_hull
            if hull.geom_type != "Polygon":
                continue
            places = {(float(a), float(b)): (a, b) for a, b in ring}
            ring = [places[p] for p in hull.exterior.coords[:-1]]
        outline = shapely.Polygon([[float(x) for x in p] for p in ring])
        if outline.is_valid and outline.area > 0.1 * size * size:
            return polygon(*ring)


def _walls(draw: _Draw, table: Table) -> None:
    """A half-space of a body and one of the tool, a pair with its own clearance."""
    rows = []
    normals = [(0, 1), (1, 0), ("0.6", "0.8"), ("-0.8", "0.6"), (-1, "0.3")]
    if draw.chance(0.3):
        normal = draw.space(*draw.rng.choice(normals))
        offset = draw.number(-1.6, -0.3)
        rows.append({"name": "wall", "type": "half-space", "body": "fore"})
        rows[-1] |= {"normal": normal, "offset": offset}
    if draw.chance(0.15):
        normal = draw.space(*draw.rng.choice(normals))
        rows.append({"name": "floor", "type": "half-space", "point": "tip"})
        rows[-1] |= {"normal": normal, "offset": draw.number(-1.6, -0.3)}
    if draw.chance(0.25):
        other = draw.rng.choice(table["obstacle"])["name"]
        rows.append({"name": "wide", "type": "bodies", "bodies": ["fore", other]})
        rows[-1]["clearance"] = draw.number(0.02, 0.2)
    if rows:
        table["boundary"] = rows


def _spheres(draw: _Draw, table: Table) -> None:
    """A sphere at the tool and one that stands, not always in the plane."""
    if not draw.chance(0.25):
        return
    table["point"][0]["radius"] = draw.number(0.01, 0.2)
    lamp = draw.space(*_around(draw, 0.5, 1.8), draw.rng.choice([0, "0.05"]))
    table["point"].append({"name": "lamp", "frame": "base", "at": lamp})
    table["point"][1]["radius"] = draw.number(0.06, 0.3)
    pair = {"name": "tip, lamp", "type": "pair", "points": ["tip", "lamp"]}
    table.setdefault("boundary", []).append(pair)


def _neighbours(table: Table) -> list[list[str]]:
    """Bodies of frames that one joint parts may touch: they meet at the joint; a hand may not."""
    names = {row["name"]: row["frame"] for row in table["body"]}
    near = [{"base", "L1"}, {"L1", "L2"}]
    pairs = [[a, b] for a in names for b in names if a < b and {names[a], names[b]} in near]
    return [pair for pair in pairs if "hand" not in pair]


# --- whole numbers and right angles ---------------------------------------------------------------


def _whole(draw: _Draw, count: int) -> Table:
    """Links and obstacles with corners in whole and half numbers, joints at right angles."""
    rng = draw.rng
    one, two = rng.randint(2, 5), rng.randint(1, 5)
    table = draw.table(*_whole_joints(draw, one))
    table["point"][0]["at"] = draw.space(two, 0)
    if draw.chance(0.6):
        table["body"].append({"frame": "L1", "name": "arm"} | _whole_link(draw, one))
    table["body"].append({"frame": draw.last, "name": "fore"} | _whole_link(draw, two))
    far = 9 if count > 12 else 6
    rows = [_whole_shape(draw, far, small=count > 12) for _ in range(count)]
    table["obstacle"] = _named(rows)
    if draw.chance(0.3):
        wall = {"name": "wall", "type": "half-space", "body": "fore"}
        normal = draw.space(*rng.choice([(0, 1), (1, 0), (3, 4)]))
        table["boundary"] = [wall | {"normal": normal, "offset": Decimal(rng.randint(-5, -1))}]
    if draw.chance(0.2):
        table["clearance"] = rng.choice([Decimal("0.5"), Decimal(1)])
    table["allowed"] = _neighbours(table)
    return table


def _whole_joints(draw: _Draw, one: int) -> tuple[list[Table], list[Any]]:
    rng = draw.rng
    joints, home = [], []
    slides = [(1, 0), (0, 1), ("0.6", "0.8")]
    rng.shuffle(slides)
    for j, kind in enumerate(draw.kinds):
        origin = (0, 0) if j == 0 else (one, 0)
        if kind == "R":
            limits = rng.choice([None, None, None, (-90, 90), (-90, 180), (0, 180), (-180, 180)])
            joints.append(draw.joint(j, origin, draw.turns(limits)))
        else:
            limits = [-rng.randint(0, 4), rng.randint(1, 5)]
            joints.append(draw.joint(j, origin, limits, slides[j]))
        home.append(0)
    return joints, home


def _whole_link(draw: _Draw, length: int) -> Table:
    which, w = draw.rng.randrange(6), Decimal(draw.rng.choice(["0.5", "0.5", "0.25", "1"]))
    if which == 0:
        return capsule((0, 0), (length, 0), draw.rng.choice([0, w]))
    if which == 1:
        return capsule((0, 0), (length, 0), w)
    if which == 2:
        return disc(length, 0, draw.rng.choice([Decimal(1), w]))
    if which == 3:
        end, w = Decimal(length), min(w, Decimal("0.5"))
        return polygon((0, -w), (end, -w), (end, 2), (end - w, 2), (end - w, w), (0, w))
    return box(0, -w, length, 2 * w)


def _whole_shape(draw: _Draw, far: int, small: bool = False) -> Table:
    rng = draw.rng
    while True:
        u, v = rng.randint(-far, far), rng.randint(-far, far)
        if max(abs(u), abs(v)) >= 2:
            break
    which = rng.randrange(5)
    if which == 0:
        return disc(u, v, Decimal("0.5") if small else rng.choice([1, 1, 2, Decimal("0.5")]))
    if which == 1:
        end = rng.choice([(u + 1, v), (u, v + 2), (u + 3, v + 4)])
        return capsule((u, v), (u + 1, v) if small else end, rng.choice(["0.5", "0.25"]))
    if which == 2:
        return polygon((u, v), (u + 1, v), (u, v + 1))
    if which == 3 and not small:
        return polygon(
            (u, v), (u + 3, v), (u + 3, v + 1), (u + 1, v + 1), (u + 1, v + 3), (u, v + 3)
        )
    side = Decimal("0.5") if small else rng.choice([1, 2])
    return box(u, v, side, rng.choice([side, 1]))


# --- ties -----------------------------------------------------------------------------------------


def _nasty(draw: _Draw, count: int) -> Table:
    """One tie on purpose, some obstacles more, and at times a number a hair away."""
    rng = draw.rng
    make = rng.choice([_twins, _corridor, _round_tangent, _end_reaches_corner, _one_line, _limits])
    table = make(draw)
    rows = [_whole_shape(draw, 8) for _ in range(rng.choice([0, 0, 1, 2]))]
    table["obstacle"] = _named([*table["obstacle"], *rows])
    table["allowed"] = _neighbours(table)
    if draw.chance(0.3):
        _by_a_hair(draw, table)
    return table


def _arm(draw: _Draw, one: int, two: int, half: Any, link: Table | None = None) -> Table:
    """Whole-number joints that carry one link, or two."""
    table = draw.table(*_whole_joints(draw, one))
    table["point"][0]["at"] = draw.space(two, 0)
    half = Decimal(half)
    if draw.chance(0.4):
        table["body"].append({"frame": "L1", "name": "arm"} | box(0, -half, one, 2 * half))
    shape = link or draw.rng.choice(
        [box(0, -half, two, 2 * half), capsule((0, 0), (two, 0), half), disc(two, 0, half)]
    )
    table["body"].append({"frame": "L2", "name": "fore"} | shape)
    return table


def _twins(draw: _Draw) -> Table:
    """Obstacles that are there twice, or stand edge on edge, or corner on corner."""
    rng = draw.rng
    table = _arm(draw, rng.randint(2, 4), rng.randint(1, 3), rng.choice(["0.5", "0.25"]))
    u, v = rng.choice([(2, 3), (-4, 1), (3, -3), (4, 3), (0, 4)])
    first = rng.choice([box(u, v, 2, 2), disc(u, v, 1), polygon((u, v), (u + 2, v), (u, v + 2))])
    same = rng.randrange(3)
    if "polygon" in first:
        corners = first["polygon"]
        across = rng.choice([(2, 0), (0, 2), (2, 2)])
        moved = [[a + across[0], b + across[1]] for a, b in corners]
        again = [{"polygon": corners}, {"polygon": corners[1:] + corners[:1]}, {"polygon": moved}]
        table["obstacle"] = [first, again[same]]
    else:
        table["obstacle"] = [first, [disc(u, v, 1), disc(u + 2, v, 1), disc(u, v, 1)][same]]
    return table


def _corridor(draw: _Draw) -> Table:
    """Two parallel walls exactly as far apart as the link is wide."""
    rng = draw.rng
    half = Decimal(rng.choice(["0.5", "0.25", "1"]))
    link = rng.choice([None, capsule((0, 0), (3, 0), half)])
    table = _arm(draw, rng.randint(1, 4), 3, half, link)
    u, v = rng.choice([(2, 0), (4, 0), (3, 1), (1, 2)])
    walls = [box(u, v + half, 2, 2), box(u, v - half - 2, 2, 2)]
    if draw.chance(0.5):
        walls = [box(v + half, u, 2, 2), box(v - half - 2, u, 2, 2)]
    table["obstacle"] = walls
    return table


def _round_tangent(draw: _Draw) -> Table:
    """A circle that a corner or the elbow goes round touches a disc from outside or inside."""
    rng = draw.rng
    u, v, far = rng.choice([*TRIPLES, (0, 1, 1), (0, 6, 6), (0, 5, 5)])
    radius = rng.randint(1, 3)
    one = abs(far - radius) if draw.chance(0.5) else far + radius
    if one == 0:
        one = far + radius
    table = _arm(draw, one, 1, "0.5")
    if draw.chance(0.5):  # a corner of the link at the elbow, or a disc about it
        corner = polygon((0, 0), (1, 0), (1, 1))
        round_elbow = disc(0, 0, rng.choice(["0.5", "1"]))
        table["body"][-1] = {"frame": "L2", "name": "fore"} | rng.choice([corner, round_elbow])
    table["obstacle"] = [disc(u, v, radius)]
    return table


def _end_reaches_corner(draw: _Draw) -> Table:
    """A link stretched out ends exactly at the corner of a polygon."""
    rng = draw.rng
    u, v, far = rng.choice(TRIPLES)
    two = rng.randint(1, far - 1)
    half = rng.choice(["0.5", "0.25"])
    which = rng.randrange(3)
    link = [box(0, -Decimal(half), two, 2 * Decimal(half)), capsule((0, 0), (two, 0), 0)]
    pointed = polygon((0, -Decimal(half)), (two, 0), (0, Decimal(half)))
    table = _arm(draw, far - two, two, half, [*link, pointed][which])
    su, sv = (1 if u > 0 else -1), (1 if v > 0 else -1)
    corner = polygon((u, v), (u + 2 * su, v), (u + 2 * su, v + 2 * sv), (u, v + 2 * sv))
    table["obstacle"] = [corner, corner] if draw.chance(0.3) else [corner]
    return table


def _one_line(draw: _Draw) -> Table:
    """Edges of some obstacles lie on one line, which a link's edge can lie on too."""
    rng = draw.rng
    table = _arm(draw, rng.randint(1, 4), rng.randint(2, 3), "0.5")
    level = rng.choice([Decimal("0.5"), Decimal("-0.5"), Decimal(2), Decimal(1)])
    starts = rng.sample(range(-6, 6, 2), rng.randint(2, 4))
    rows = [box(s, level, rng.choice([1, 2]), rng.choice([1, 2])) for s in starts if abs(s) > 1]
    rows.append(box(3, level - 1, 1, 1) if draw.chance(0.4) else box(5, level, 1, 1))
    table["obstacle"] = rows
    return table


def _limits(draw: _Draw) -> Table:
    """Contact at exactly the limit of a joint: a link that lies on a wall at right angles."""
    rng = draw.rng
    half = Decimal("0.5")
    table = _arm(draw, rng.randint(1, 3), 2, half)
    for joint in table["joint"]:
        if joint["type"] == "revolute":
            joint["limits"] = draw.turns(rng.choice([(-90, 90), (0, 180), (-90, 0), (0, 90)]))
    table["obstacle"] = [box(-6, half, 12, 1), box(-6, -half - 1, 3, 1), box(4, -3, 1, 2)]
    return table


def _by_a_hair(draw: _Draw, table: Table) -> None:
    """One number of an obstacle larger or smaller by 1e-12 or 1e-16."""
    hair = Decimal(draw.rng.choice(["1e-12", "-1e-12", "1e-16", "-1e-16"]))
    row = draw.rng.choice(table["obstacle"])
    if "polygon" in row:
        k = draw.rng.randrange(len(row["polygon"]))
        corners = [list(p) for p in row["polygon"]]
        corners[k][draw.rng.randrange(2)] += hair
        row["polygon"] = corners
    else:
        (key,) = {"disc", "capsule"} & set(row)
        row[key] = row[key] | {"radius": row[key]["radius"] + hair}
