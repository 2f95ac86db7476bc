"""Check a certificate of qbound with nothing but Python's own integers.

    python check.py CERTIFICATE [ROBOT_FILE | --sha256 HASH]

Exit status: 0 proved, 1 refuted, 2 malformed, proves nothing, or is about another robot. The file
holds a robot as text, a set of configurations made of simplices (segments, triangles, ...), and for
each boundary and simplex a tree: "." is a leaf, a letter halves the simplex across an edge: leaves
cover the set. A boundary function is a sum of waves, beta = sum Re A exp(i w . q). On a leaf with
centre m, beta(m) + grad beta(m) . d - 1/2 sum |A| (w . d)^2 > 0 is verified at each corner m + d;
this bounds beta(m + d) from below and is concave in d, so that it is positive in between as well.
"""
import collections, hashlib, json, math, pathlib, re, sys, tomllib
from fractions import Fraction
from itertools import combinations, pairwise, permutations, product
from operator import add, mul, sub

BITS, MAX_FILE, MAX_WORK, MAX_JOINTS, MAX_DEPTH = 128, 2_000_000, 1_000_000, 6, 120
DECIMAL = r"[+-]?\d[\d_]{0,40}(\.\d[\d_]{0,40})?([eE][+-]?\d{1,2})?"
def demand(condition, text):
    if not condition: raise ValueError(text)
def number(value) -> Fraction:
    text = str(value) if type(value) is int and abs(value) < 10**30 else value
    demand(type(text) is str and re.fullmatch(DECIMAL, text, re.ASCII), "not a decimal number")
    return Fraction(text.replace("_", ""))
class Ball:
    """The complex numbers no farther than r from x + i y; x, y, r in units of 2^-BITS."""
    def __init__(self, x, y=0, r=0): self.x, self.y, self.r = x, y, r
    def __add__(self, b): return Ball(self.x + b.x, self.y + b.y, self.r + b.r)
    def __sub__(self, b): return Ball(self.x - b.x, self.y - b.y, self.r + b.r)
    def __abs__(self): return Ball(math.isqrt(self.x**2 + self.y**2) + self.r + (self.y != 0))
    def __mul__(self, b):
        Ball.work += 1; demand(Ball.work < MAX_WORK, "too much work")
        x, y = self.x * b.x - self.y * b.y, self.x * b.y + self.y * b.x
        r = (abs(self.x) + abs(self.y)) * b.r + self.r * (abs(b.x) + abs(b.y) + b.r)
        return Ball(x >> BITS, y >> BITS, -(-r >> BITS) + (2 if (x | y) % (1 << BITS) else 0))
def ball(x):
    m, rest = divmod(Fraction(x).numerator << BITS, Fraction(x).denominator)
    return Ball(m, 0, int(rest != 0))
ZERO, ONE, HALF, I = Ball(0), Ball(1 << BITS), Ball(1 << BITS - 1), Ball(0, 1 << BITS)
PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
def exp_i(angle):
    """Taylor's series: fewer than 2^8 terms, each cut by a unit that later ones raise to < e^32."""
    demand(abs(angle).x < 32 << BITS, "an angle of more than five turns")
    term, sums, i = 1 << BITS, [0, 0], 0
    while term not in (0, -1):
        sums[i % 2] += -term if i % 4 > 1 else term
        i, term = i + 1, (term * angle.x >> BITS) // (i + 1)
    return Ball(*sums, angle.r + (1 << 56) if angle.x or angle.r else 0)
def vector(values, direction=False):
    x, y, z = exact = [number(value) for value in values]
    square = 4**BITS / (x * x + y * y + z * z) if direction else Fraction(4**BITS)
    root = math.isqrt(int(square))
    return [ball(value) * Ball(root, 0, int(root**2 != square)) for value in exact]
def dot(u, v): return sum(map(mul, u, v), ZERO)
def turned(u, axis):
    """Return a, b, c: the vector u turned by t about a unit axis is a + b exp(it) + c exp(-it)."""
    along, (x, y, z) = [dot(axis, u) * a for a in axis], axis
    cross = [I * c for c in (y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0])]
    rows = list(zip(map(sub, u, along), cross))
    return along, [(a - c) * HALF for a, c in rows], [(a + c) * HALF for a, c in rows]

class Robot:
    def __init__(self, text) -> None:
        table = tomllib.loads(text, parse_float=str)
        rows = [table["joint"], table["point"], table.get("boundary", [])]
        self.name, self.joints, self.still = table["name"], table["joint"], (0,) * len(rows[0])
        self.points, self.walls = ({row["name"]: row for row in part if row.get("used", True)}
                                   for part in rows[1:])
        self.frames = [self.joints[0]["parent"], *(joint["frame"] for joint in self.joints)]
        self.radian = {"deg": ball(PI / 180), "rad": ONE}[table["angle_unit"]]
        self.turns = [{"revolute": 1, "prismatic": 0}[joint["type"]] for joint in self.joints]
        names = [self.frames, *([row["name"] for row in part] for part in rows)]
        demand(all(len({*x}) == len(x) for x in names), "a name is used twice")
        chain = [joint["parent"] for joint in self.joints] == self.frames[:-1]
        demand(chain and len(self.joints) <= MAX_JOINTS, f"no chain of up to {MAX_JOINTS} joints")
    def waves(self, wall, margin):
        """Return the distance to keep, and the boundary function as {k: A}: the sum of A times all
        exp(i k_j q_j), or q_j to the power k_j for the joints that slide."""
        pair, still = {"pair": 1, "half-space": 0}[wall["type"]], self.still
        ends = [self.points[name] for name in (wall["points"] if pair else [wall["point"]])]
        gap = sum(number(end.get("radius", 0)) for end in ends) + margin
        gap += number(wall.get("clearance", 0) if pair else wall["offset"])
        ends.sort(key=lambda end: self.frames.index(end["frame"]))
        first, last = (self.frames.index(end["frame"]) for end in (ends[0], ends[-1]))
        u = {still: vector(ends[-1]["at"])}  # the far point, seen from frame after frame
        for j in reversed(range(first if pair else 0, last)):
            joint, axis = self.joints[j], vector(self.joints[j]["axis"], direction=True)
            new = [(k, s, a) for k, v in u.items() for s, a in zip((0, 1, -1), turned(v, axis))]
            if not self.turns[j]: new = [*((k, 0, v) for k, v in u.items()), (still, 1, axis)]
            u = {(*k[:j], s, *k[j + 1 :]): a for k, s, a in new}
            for i, angle in enumerate(joint.get("rpy", [])):
                fixed, angle = [Ball((i == k) << BITS) for k in range(3)], ball(number(angle))
                steps = ONE, exp_i(angle * self.radian), exp_i(ZERO - angle * self.radian)
                u = {k: [dot(x, steps) for x in zip(*turned(v, fixed))] for k, v in u.items()}
            u[still] = list(map(add, u[still], vector(joint["origin"])))
        if pair: u[still] = list(map(sub, u[still], vector(ends[0]["at"])))
        form = {still: ZERO - ball(gap**2 if pair else gap)}
        other = u if pair else {still: vector(wall["normal"], direction=True)}
        for (k, a), (l, b) in product(u.items(), other.items()):
            key = tuple(map(add, k, l))
            if max(map(abs, map(mul, key, self.turns))) < 2:  # turns keep lengths: the rest cancels
                form[key] = form.get(key, ZERO) + dot(a, b)
        return gap, {k: a for k, a in form.items() if a.x or a.y or a.r}
    def bounds(self, waves, corners):
        """Return the bound at each corner; of one point, the value. For a wave times slides the
        product rule bounds the second derivative along d; a lone square bends upwards."""
        centre = [sum(x) / len(corners) for x in zip(*corners)]
        steps, low = [[*map(sub, corner, centre)] for corner in corners], [ZERO] * len(corners)
        for k, a in waves.items():
            if (w := [*map(mul, k, self.turns)]) < [*self.still]: continue  # mirrored, see a + a
            a = a + a if any(w) else a
            slides = [j for j, power in enumerate(k) if not self.turns[j] for _ in range(power)]
            at, *turns = (ball(sum(map(mul, w, x))) * self.radian for x in (centre, *steps))
            wave, lone = a * exp_i(at), not any(w) and sum(k) == max(k) == 2 and a.x > a.r
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
        """Walk a tree, an iterator of letters; of a cut cell the half with end i comes first."""
        if (letter := next(tree, "")) == ".":
            return all(low.x > low.r for low in self.bounds(waves, cell))
        demand(depth < MAX_DEPTH and "a" <= letter <= "z", "a tree ends early, or no tree")
        i, k = [*combinations(range(len(cell)), 2)][ord(letter) - ord("a")]
        middle = tuple((x + y) / 2 for x, y in zip(cell[i], cell[k]))
        halves = ([middle if j == end else x for j, x in enumerate(cell)] for end in (k, i))
        return all(self.proves(waves, half, tree, depth + 1) for half in halves)
    def beyond(self, q):
        rows = [(j["name"], x, j["limits"]) for j, x in zip(self.joints, q) if "limits" in j]
        low, high = ({n for n, x, ends in rows if s * x < s * number(ends[s < 0])} for s in (1, -1))
        return {f"{name}.lower" for name in low} | {f"{name}.upper" for name in high}
def read_cells(statement) -> list:  # of simplices, each a list of corners
    loops = [[tuple(map(number, point)) for point in loop] for loop in statement["points"]]
    kind, points = statement["set"], [point for loop in loops for point in loop]
    demand(kind in ("path", "box", "polygon") and min(map(len, loops)) > 1, "an unknown set")
    if kind == "path": return [list(ends) for loop in loops for ends in pairwise(loop)]
    if kind == "box":  # cut once for each order in which low ends may turn into high ones
        orders = permutations(j for j, (x, y) in enumerate(zip(*points, strict=True)) if x != y)
        ups = [[order[:k] for k in range(len(order) + 1)] for order in orders]
        return [[tuple(x[j in up] for j, x in enumerate(zip(*points))) for up in o] for o in ups]
    free = [j for j, values in enumerate(zip(*points)) if len({*values}) > 1]
    cells = [[points[i] for i in triangle] for triangle in statement["triangles"]]
    edges = collections.Counter(edge for loop in loops for edge in pairwise([*loop, loop[0]]))
    demand(all((b, a) not in edges for a, b in edges), "a loop goes back along itself")
    for a, b, c in cells:  # anticlockwise, their edges adding up to the loops: they tile the inside
        (x, y), (u, v) = ([p[j] - a[j] for j in free] for p in (b, c))
        demand(x * v > y * u, "a triangle is not anticlockwise")
        edges.subtract([(a, b), (b, c), (c, a)])
    demand(all(n == edges[b, a] for (a, b), n in edges.items()), "the triangles miss the polygon")
    return cells
def unique(pairs):
    demand(len(dict(pairs)) == len(pairs), "a key is there twice")
    return dict(pairs)
def digest(text) -> str: return hashlib.sha256(text.encode()).hexdigest()

def check(text: str | bytes, pin: str | None = None) -> tuple[bool, str]:
    """Return whether the statement is refuted (else it is proved), and what is to be said of it."""
    Ball.work, content = 0, json.loads(text, object_pairs_hook=unique)
    robot, sha256, verdict = Robot(content["robot"]), digest(content["robot"]), content["verdict"]
    demand(sha256 == content["sha256"] and pin in (None, sha256), f"another robot: sha256 {sha256}")
    cells, margin = read_cells(content["statement"]), number(content["statement"]["margin"])
    demand(content["schema"] == "qbound/certificate/1" and cells and margin >= 0, "no statement")
    demand({len(q) for cell in cells for q in cell} == {len(robot.joints)}, "not one value a joint")
    said = f"robot {robot.name!a}, sha256 {sha256}\n{verdict}: "
    walls = {name: robot.waves(wall, margin) for name, wall in robot.walls.items()}
    if ["proved", "refuted"].index(verdict):
        name, cell = content["boundary"], cells[content["cell"]]
        weights = [number(x) for x in content["weights"]]
        demand(len(weights) == len(cell), "a witness has one weight for each corner of its cell")
        demand(min(weights) >= 0 and sum(weights) == 1, "the weights of no configuration")
        q = [sum(map(mul, x, weights)) for x in zip(*cell, strict=True)]
        [value] = robot.bounds(walls[name][1], [q]) if name in walls else [ZERO]
        demand(name in robot.beyond(q) or value.x + value.r < 0, "the witness violates nothing")
        return True, f"{said}{name!a} is violated at {[float(x) for x in q]}"
    demand(not any(robot.beyond(q) for cell in cells for q in cell), "beyond a limit of a joint")
    for name, (gap, waves) in walls.items():  # a pair with nothing to keep is at least 0 apart
        if gap or robot.walls[name]["type"] != "pair":
            for cell, letters in zip(cells, content["proof"][name], strict=True):
                tree = iter(letters)
                demand(robot.proves(waves, cell, tree) and not next(tree, ""), f"{name}: no proof")
    return False, f"{said}{[*walls]} and limits, all over {json.dumps(content['statement']):.1500}"

def main(arguments: list[str]) -> int:
    try:
        with pathlib.Path(arguments[0]).open("rb") as file: text = file.read(MAX_FILE + 1)
        demand(len(text) <= MAX_FILE, f"more than {MAX_FILE} bytes")
        demand("" not in arguments[1:] and arguments[-1] != "--sha256", "a pin without a value")
        pin = arguments[2:] if "--sha256" in arguments else [
            digest(pathlib.Path(file).read_text("utf-8-sig")) for file in arguments[1:]]
        status, said = check(text, *pin)
    except Exception as error:  # whatever a hostile file sets off
        status, said = 2, f"not proved: {type(error).__name__}: {str(error)!a:.300}"
    print(said)
    return int(status)
if __name__ == "__main__": sys.exit(main(sys.argv[1:]))
