"""Check a certificate of qbound with nothing but Python's own integers.

    python check.py CERTIFICATE [ROBOT_FILE | --sha256 HASH]

Exit status: 0 proved, 1 refuted, 2 malformed, proves nothing, or is about another robot.

The file holds a robot as text, a set of configurations made of simplices (segments, triangles, ...),
and for each boundary and simplex a tree: "." is a leaf, a letter halves the simplex across that edge.
So the leaves cover the set. A boundary function is a sum of waves, beta = sum Re A exp(i w . q). On
a leaf with centre m it is verified at each corner m + d that
    beta(m) + grad beta(m) . d - 1/2 sum |A| (w . d)^2 > 0.
The left side bounds beta(m + d) from below and is concave in d, so that it is positive in between.
"""
import hashlib, json, re, sys, tomllib
from collections import Counter
from fractions import Fraction
from itertools import combinations, pairwise, permutations, product
from math import isqrt
from operator import add, mul, sub
from pathlib import Path

BITS, MAX_FILE, MAX_JOINTS, MAX_DEPTH, MAX_ROBOT = 128, 4_000_000, 6, 120, 50_000
WORDS = """schema name length_unit angle_unit home tool joint point boundary body type parent frame
    origin rpy axis limits velocity at radius points clearance used normal offset""".split()

def demand(condition, text):
    if not condition:
        raise ValueError(text)

def number(value):
    text = str(value) if type(value) is int and abs(value) < 10**30 else value
    form = r"[+-]?\d[\d_]{0,40}(\.\d[\d_]{0,40})?([eE][+-]?\d{1,2})?"
    demand(type(text) is str and re.fullmatch(form, text, re.ASCII), "not a decimal number")
    return Fraction(text.replace("_", ""))

class Ball:
    """The complex numbers no farther than r from x + i y; x, y, r in units of 2^-BITS."""
    def __init__(self, x, y=0, r=0): self.x, self.y, self.r = x, y, r
    def __add__(self, b): return Ball(self.x + b.x, self.y + b.y, self.r + b.r)
    def __sub__(self, b): return Ball(self.x - b.x, self.y - b.y, self.r + b.r)
    def __abs__(self): return Ball(isqrt(self.x**2 + self.y**2) + self.r + (self.y != 0))
    def __mul__(self, b):
        x, y = self.x * b.x - self.y * b.y, self.x * b.y + self.y * b.x
        r = (abs(self.x) + abs(self.y)) * b.r + self.r * (abs(b.x) + abs(b.y) + b.r)
        return Ball(x >> BITS, y >> BITS, -(-r >> BITS) + (2 if (x | y) % (1 << BITS) else 0))

def ball(x):
    m, rest = divmod(Fraction(x).numerator << BITS, Fraction(x).denominator)
    return Ball(m, 0, int(rest != 0))

ZERO, ONE, HALF, I = Ball(0), Ball(1 << BITS), Ball(1 << BITS - 1), Ball(0, 1 << BITS)
PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")

def exp_i(angle):
    """Taylor's series: fewer than 2^8 terms, each cut by a unit that later terms raise to < e^32."""
    demand(abs(angle).x < 32 << BITS, "an angle of more than five turns")
    term, sums, i = 1 << BITS, [0, 0], 0
    while term not in (0, -1):
        sums[i % 2] += -term if i % 4 > 1 else term
        i, term = i + 1, (term * angle.x >> BITS) // (i + 1)
    return Ball(*sums, angle.r + (1 << 56) if angle.x or angle.r else 0)

def dot(u, v):
    return sum(map(mul, u, v), ZERO)

def vector(values, direction=False):
    x, y, z = exact = [number(value) for value in values]
    square = 4**BITS / (x * x + y * y + z * z) if direction else Fraction(4**BITS)
    root = Ball(isqrt(int(square)), 0, int(isqrt(int(square)) ** 2 != square))
    return [ball(value) * root for value in exact]

def turned(u, axis):
    """Return a, b, c: the vector u turned by t about a unit axis is a + b exp(i t) + c exp(-i t)."""
    along, (x, y, z) = [dot(axis, u) * a for a in axis], axis
    cross = [I * c for c in (y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0])]
    rows = list(zip(map(sub, u, along), cross))
    return along, [(a - c) * HALF for a, c in rows], [(a + c) * HALF for a, c in rows]

class Robot:
    def __init__(self, text):
        demand(len(text) <= MAX_ROBOT, "a robot file too large")
        table = tomllib.loads(text, parse_float=str)
        rows = [table["joint"], table["point"], table.get("boundary", [])]
        demand({*table, *(key for row in sum(rows, []) for key in row)} <= {*WORDS}, "unknown key")
        self.name, self.joints, self.still = table["name"], table["joint"], (0,) * len(rows[0])
        self.points, self.walls = ({row["name"]: row for row in part} for part in rows[1:])
        self.frames = [self.joints[0]["parent"], *(joint["frame"] for joint in self.joints)]
        self.radian = {"deg": ball(PI / 180), "rad": ONE}[table["angle_unit"]]
        self.turns = [{"revolute": 1, "prismatic": 0}[joint["type"]] for joint in self.joints]
        names = [self.frames, *([row["name"] for row in part] for part in rows)]
        demand(all(len({*part}) == len(part) for part in names), "a name is used twice")
        demand([j["parent"] for j in self.joints] == self.frames[:-1], "the joints form no chain")
        demand(len(self.joints) <= MAX_JOINTS, f"more than {MAX_JOINTS} joints")

    def position(self, point, first):
        """Return what frame `first` sees as vector waves {k: A}: the sum of A times exp(i k_j q_j)
        for each joint that turns, times q_j to the power k_j for each that slides."""
        u = {self.still: vector(point["at"])}
        for j in reversed(range(first, self.frames.index(point["frame"]))):
            joint, axis = self.joints[j], vector(self.joints[j]["axis"], direction=True)
            new = [(k, s, a) for k, v in u.items() for s, a in zip((0, 1, -1), turned(v, axis))]
            if not self.turns[j]:
                new = [*((k, 0, v) for k, v in u.items()), (self.still, 1, axis)]
            u = {(*k[:j], s, *k[j + 1 :]): a for k, s, a in new}
            for i, angle in enumerate(joint.get("rpy", [])):
                fixed, angle = [Ball((i == k) << BITS) for k in range(3)], ball(number(angle))
                steps = ONE, exp_i(angle * self.radian), exp_i(ZERO - angle * self.radian)
                u = {k: [dot(x, steps) for x in zip(*turned(v, fixed))] for k, v in u.items()}
            u[self.still] = list(map(add, u[self.still], vector(joint["origin"])))
        return u

    def waves(self, wall, margin):
        """Return the distance to keep, and the boundary function as waves {k: A}."""
        pair = {"pair": 1, "half-space": 0}[wall["type"]]
        ends = [self.points[name] for name in (wall["points"] if pair else [wall["point"]])]
        gap = sum(number(end.get("radius", 0)) for end in ends) + margin
        gap += number(wall.get("clearance", 0) if pair else wall["offset"])
        near, far = sorted((self.frames.index(ends[i]["frame"]), i) for i in (0, -1))
        u = self.position(ends[far[1]], near[0] if pair else 0)
        v = u if pair else {self.still: vector(wall["normal"], direction=True)}
        if pair:
            u[self.still] = list(map(sub, u[self.still], vector(ends[near[1]]["at"])))
        form = {self.still: ZERO - ball(gap**2 if pair else gap)}
        for k, l in product(u, v):
            key = tuple(map(add, k, l))
            if max(map(abs, map(mul, key, self.turns))) < 2:  # a turn keeps lengths: the rest cancels
                form[key] = form.get(key, ZERO) + dot(u[k], v[l])
        return gap, {k: a for k, a in form.items() if a.x or a.y or a.r}

    def bounds(self, waves, corners):
        """Return the lower bound at each corner; of a single point, the value. The product rule
        bounds the second derivative along d of a wave times slides; a lone square bends upwards."""
        centre = [sum(values) / len(corners) for values in zip(*corners)]
        steps = [[*map(sub, corner, centre)] for corner in corners]
        low = [ZERO] * len(corners)
        for k, a in waves.items():
            w, slides = [*map(mul, k, self.turns)], [j for j, n in enumerate(k) if not self.turns[j] for _ in range(n)]
            if w < [*self.still]: continue
            a = a + a if any(w) else a
            at, *turns = (ball(sum(map(mul, w, x))) * self.radian for x in (centre, *steps))
            wave, lone = a * exp_i(at), not any(w) and len(slides) == 2 > len({*slides}) and a.x > a.r
            for i, step in enumerate(steps):
                u = Ball(max(abs(turn).x for turn in turns)) if slides else turns[i]
                x, dx, y, dy, ddy = wave, I * wave * turns[i], abs(a), abs(a) * u, abs(a) * u * u
                for j in slides:
                    x, dx = x * ball(centre[j]), dx * ball(centre[j]) + x * ball(step[j])
                    q, d = (ball(max(abs(row[j]) for row in rows)) for rows in (corners, steps))
                    y, dy, ddy = y * q, dy * q + y * d, ddy * q + (dy + dy) * d
                low[i] += x + dx - (ZERO if lone else ddy * HALF)
        return low

    def proves(self, waves, cell, tree, depth=0):
        """Walk a tree, an iterator of letters; of a cut cell the half with the first end is first."""
        letter = next(tree, "")
        if letter == ".":
            return all(low.x > low.r for low in self.bounds(waves, cell))
        demand(depth < MAX_DEPTH and "a" <= letter <= "z", "a tree ends early, or no tree")
        i, k = [*combinations(range(len(cell)), 2)][ord(letter) - ord("a")]
        middle = tuple((x + y) / 2 for x, y in zip(cell[i], cell[k]))
        parts = ([middle if j == end else x for j, x in enumerate(cell)] for end in (k, i))
        return all(self.proves(waves, part, tree, depth + 1) for part in parts)

def read_cells(statement):
    """Return the simplices that make up the stated set, each a list of corners."""
    loops = [[tuple(map(number, point)) for point in loop] for loop in statement["points"]]
    if statement["set"] == "path":
        return [list(ends) for loop in loops for ends in pairwise(loop)]
    if statement["set"] == "box":  # cut once for each order in which low may turn into high
        low, high = loops[0]
        orders = permutations(j for j, (a, b) in enumerate(zip(low, high, strict=True)) if a != b)
        mixed = [[order[:k] for k in range(len(order) + 1)] for order in orders]
        return [[tuple((low, high)[j in up][j] for j in range(len(low))) for up in x] for x in mixed]
    demand(statement["set"] == "polygon", "an unknown kind of set")
    points = sum(loops, [])
    free = [j for j, x in enumerate(zip(*points, strict=True)) if len({*x}) > 1]
    cells = [[points[i] for i in triangle] for triangle in statement["triangles"]]
    edges = Counter(edge for loop in loops for edge in pairwise([*loop, loop[0]]))
    for a, b, c in cells:  # anticlockwise, their edges adding up to the loops: they tile the inside
        (x, y), (u, v) = ([p[j] - a[j] for j in free] for p in (b, c))
        demand(x * v > y * u, "a triangle is not anticlockwise")
        edges.subtract([(a, b), (b, c), (c, a)])
    demand(all(n == edges[b, a] for (a, b), n in edges.items()), "the triangles are not the polygon")
    return cells

def unique(pairs):
    demand(len(dict(pairs)) == len(pairs), "a key is there twice")
    return dict(pairs)

def check(text, pin=None):
    """Return whether the statement is refuted (else it is proved), and what is to be said of it."""
    content = json.loads(text, object_pairs_hook=unique)
    robot, sha256 = Robot(content["robot"]), hashlib.sha256(content["robot"].encode()).hexdigest()
    demand(sha256 == content["sha256"] and pin in (None, sha256), f"another robot: sha256 {sha256}")
    statement, margin = content["statement"], number(content["statement"]["margin"])
    demand(content["schema"] == "qbound/certificate/1" and margin >= 0, "no such schema or margin")
    cells, said = read_cells(statement), f"robot {robot.name!a}, sha256 {sha256}\n"
    demand({len(q) for cell in cells for q in cell} == {len(robot.joints)}, "values are not one a joint")
    walls = {k: wall for k, wall in robot.walls.items() if wall.get("used", True) is not False}
    limits = {f"{joint['name']}.{side}": (j, sign, number(joint["limits"][sign < 0]))
              for j, joint in enumerate(robot.joints) if "limits" in joint
              for side, sign in (("lower", 1), ("upper", -1))}
    if content["verdict"] == "refuted":
        name, weights = content["boundary"], [number(x) for x in content["weights"]]
        demand(min(weights) >= 0 and sum(weights) == 1, "the weights of the witness")
        q = [sum(map(mul, x, weights)) for x in zip(*cells[content["cell"]], strict=True)]
        if name in walls:
            gap, waves = robot.waves(walls[name], margin)
            [value] = robot.bounds(waves, [q])
            demand(value.x < -value.r, "the witness keeps the boundary")
            depth = gap - Fraction(isqrt(max(0, int(gap**2 * 4**BITS) + (value.x << BITS))), 2**BITS)
            depth = depth if walls[name]["type"] == "pair" else Fraction(-value.x, 2**BITS)
        else:
            j, sign, end = limits[name]
            depth = sign * (end - q[j])
            demand(depth > 0, "the witness keeps the limit")
        return True, f"{said}refuted: {name!a} by {float(depth)} at {[float(x) for x in q]}"
    demand(cells and content["verdict"] == "proved", "nothing is said")
    for j, sign, end in limits.values():
        demand(all(sign * (q[j] - end) >= 0 for cell in cells for q in cell), "beyond a limit")
    for name, wall in walls.items():
        gap, waves = robot.waves(wall, margin)
        if gap or wall["type"] != "pair":  # else the distance is never below 0
            for cell, letters in zip(cells, content["proof"][name], strict=True):
                tree = iter(letters)
                demand(robot.proves(waves, cell, tree) and not next(tree, ""), f"{name!a}: no proof")
    return False, f"{said}proved: {[*walls, *limits]} hold at all of {json.dumps(statement):.1000}"

def main(arguments):
    try:
        with Path(arguments[0]).open("rb") as file:
            text = file.read(MAX_FILE + 1)
        demand(len(text) <= MAX_FILE, f"more than {MAX_FILE} bytes")
        pin = arguments[2] if arguments[1:2] == ["--sha256"] else None
        if len(arguments) == 2:
            pin = hashlib.sha256(Path(arguments[1]).read_bytes()).hexdigest()
        refuted, said = check(text, pin)
    except Exception as error:  # whatever a hostile file sets off
        print(f"not proved: {type(error).__name__}: {str(error)!a:.300}")
        return 2
    print(said)
    return int(refuted)

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
