# ruff: noqa: E501  (one table, a case a line)
"""Certificates that checker and oracle accept or refuse, and the command of a stranger."""

import ast
import hashlib
import json
import math
import re
import resource
import shlex
import subprocess
import sys
from importlib import resources
from pathlib import Path

import pytest
from jsonschema import validate

pytest.importorskip("flint")

from cspace import check
from cspace.model.robotfile import packaged_robots, robot_text
from engine_support import brute_force, second_checker
from engine_support.certificates import Draft, drop, in_robot, proved, put, rehash
from engine_support.claims import (
    ARM,
    BODIES,
    FREE,
    HALVES,
    MAKERS,
    SEGMENTS,
    SQUARE,
    between,
    box,
    moved,
    original,
    path,
    polygon,
)
from engine_support.robot_files import ALL_KINDS, robot_file

FILE = Path(check.__file__)


def first(data):
    return ("proved", "refuted")[check.check(data).refuted]


CHECKERS = {"first": first, "second": second_checker.verify}


def file_of(data):
    return data if isinstance(data, str | bytes) else json.dumps(data)


def verdict(checker, data):
    """Return what a checker says, or its refusal."""
    try:
        return CHECKERS[checker](file_of(data))
    except ValueError as refusal:
        return refusal


def changed(name, change):
    """Return a certificate after a change, which may return another one instead."""
    data = original(name)
    return change(data) or data


# --- what is accepted -----------------------------------------------------------------------------


def test_the_oracle_shares_no_code_with_what_it_judges():
    tree = ast.parse(Path(second_checker.__file__).read_text(encoding="utf-8"))
    names = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    ours = {name for name in names if name.startswith(("cspace", "support"))}
    assert ours
    assert all(name.startswith("cspace.model.") for name in ours)


@pytest.mark.parametrize("name", MAKERS)
def test_checker_and_oracle_accept_what_is_true(name):
    data = original(name)
    wanted, schema = MAKERS[name][0], resources.files(check.__package__) / "schemas"
    validate(data, json.loads((schema / "certificate.schema.json").read_text(encoding="utf-8")))
    assert brute_force.tells_the_truth(data)
    assert [verdict(checker, data) for checker in CHECKERS] == [wanted] * 2


POINTS, TREES = ("claim", "points"), ("proof", "trees")
ROOT, PLACES = ("proof", "tree"), ("proof", "places")
START, GOAL = (*POINTS, 0, 0, 0), (*POINTS, 0, 1, 0)


def each(change):
    """Return a change of every item of a list."""
    return lambda row: [*map(change, row)]


def also(*changes):
    """Return some changes one after the other."""

    def change(data):
        for each_one in changes:
            each_one(data)

    return change


ACCEPTED = {
    "bodies on a parallelogram": (
        "segments",
        lambda _: proved(SEGMENTS.replace('"revolute", ', '"parallelogram", bar = "b", crank = [1, 0, 0], '), box("60", "120")),
    ),
    "decimals with exponents": ("box", put(*POINTS, [[["-1.0e1", "-2E+1"], ["0.8e+1", "120E-1"]]])),
    "zeros before a number": ("box", put(*POINTS, 0, 1, 1, "0012.000")),
    "a 0 with a sign": ("path", put(*POINTS, 0, 0, 0, "-0")),
    "a number of 40 digits and its exponent": ("path", put(*POINTS, 0, 0, 0, "0." + "0" * 39 + "e-99")),
    "blanks between marks": ("box", lambda d: json.dumps(d, indent=7)),
    "escapes in strings": ("box", lambda d: json.dumps(d).replace('"box"', r'"\u0062ox"')),
    "a leaf that is cut": ("box", put(*TREES, 0, 0, "a..")),
    "a direction that no leaf names": ("box", put("proof", "directions", lambda d: [*d, [0, -7, 0]])),
    "a place that no leaf names": ("no path", put(*PLACES, lambda d: [*d, d[0]])),
    "a goal some turns on": ("no path", put(*GOAL, "1340")),
    "a goal some turns back, one held": ("no path, one held", put(*GOAL[:-1], ["-905", "-0.3"])),
    "a start some turns back": ("no path", put(*START, "-1730")),
    "a goal some turns on, in radians": ("no path, radians", put(*GOAL, "23.2327412287184")),
    "a margin of no path": ("no path", put("claim", "margin", "0.01")),
    "a start that a cut passes through": ("no path", put(*START, "90")),
    "a smaller margin": ("bodies, square", put("claim", "margin", "0.001")),
    "squares that share a corner": ("two squares", put(*POINTS, 1, moved(SQUARE, 8))),
    "parts from another corner on": ("bodies", also(put("parts", "hook", each(lambda p: p[1:] + p[:1])), rehash)),
    "another comment in the robot": ("box", in_robot("schema = 1", "# another arm?\nschema = 1")),
    "another home and tool": ("box", in_robot('q2 = 0 }\ntool = "tip"', 'q2 = 9 }\ntool = "post"')),
    "a name in another script": ("box", in_robot('"arm"', '"Größe \u202e \U0001f916"')),
    "limits of a hundred turns": ("lift", in_robot("limits = [-1, 1]", "limits = [-1, 627.3185307179586476925286766559005768]")),
    "numbers of the robot in other words": ("box", in_robot("[3, 0, 0]", "[+30_0.0e-2, -0.0, 0]")),
    "a place of a longer sum": ("witness in the crate", put("witness", "place", "near", ["0.25", "0.250", "25e-2", "0.25"])),
    "no discs where they are not needed": ("witness of a crossing", drop("witness", "place", "inside")),
}  # fmt: skip


@pytest.mark.parametrize("checker", CHECKERS)
@pytest.mark.parametrize("name", ACCEPTED)
def test_what_says_the_same_in_other_words_is_accepted(name, checker):
    start, change = ACCEPTED[name]
    assert verdict(checker, changed(start, change)) == MAKERS[start][0]


# --- what is refused ------------------------------------------------------------------------------

DECIMALS = ("4 ", " 4", "4\n", "+4", ".4", "4.", "4_0", "4e400", "4e1000", "4e", "e4", "nan", "inf",
            "", "-", "--4", "0x4", "\uff14", "\u0664", "4/1", "1" * 41, "1e101", "1e-101", "4,0")  # fmt: skip
NO_DECIMALS = (4, 4.0, True, None, ["4"], {"4": 4})


def text_of(change):
    """Return a change of the written file."""
    return lambda data: change(json.dumps(data))


def all_around(loop, triangles):
    """Return the change to a polygon with loops and triangles of its own."""
    return also(
        put(*POINTS, loop),
        put("claim", "triangles", triangles),
        put(*TREES, each(lambda row: [row[0]] * len(triangles))),
    )


JSON = {
    "not JSON": ("box", lambda _: "hello", "the file is not JSON: "),
    "a list": ("box", lambda _: "[]", "schema: qbound/certificate/6 is wanted; older formats are not read any"),
    "a byte order mark": ("box", text_of(lambda t: "\ufeff" + t), "the file is not JSON: "),
    "UTF-16": ("box", text_of(lambda t: t.encode("utf-16")), "the file is not UTF-8 text"),
    "half a character": ("box", text_of(lambda t: t.encode() + b"\xed\xa0\x80"), "the file is not UTF-8 text"),
    "half a character in a name": ("box", put("parts", {"\ud800": []}), "parts: unknown key '\\ud800'"),
    "half a character in the robot": ("box", put("robot", lambda t: t + "#\ud800"), "the file.robot: a text of 1 to 500000 characters is wanted"),
    "something after the end": ("box", text_of(lambda t: t + "{}"), "the file is not JSON: "),
    "a key twice within": ("box", text_of(lambda t: t.replace('"set"', '"margin": "0", "set"')), "the file has a key twice in one object"),
    "NaN": ("box", text_of(lambda t: t.replace('"margin": "0"', '"margin": NaN')), "the file has the number 'NaN': decimals are written as strings"),
    "a float": ("polygon", text_of(lambda t: t.replace("[[0, 1, 2]", "[[0.0, 1, 2]")), "the file has the number '0.0': decimals are written as strings"),
    "an integer of ten digits": ("polygon", text_of(lambda t: t.replace("[[0, 1, 2]", "[[0, 1, 1000000000]")), "the file has the number '1000000000': decimals are written as strings"),
    "lists in lists": ("box", lambda _: "[" * 1_000_000, "the file is nested too deeply"),
    "tables in tables": ("box", lambda _: '{"a":' * 300_000, "the file is nested too deeply"),
    "a file of more than 4 MB": ("box", text_of(lambda t: t + " " * 4_000_000), "the file has more than 4000000 bytes"),
}  # fmt: skip

HEAD = {
    **{f"format {k}": ("box", put("schema", f"qbound/certificate/{k}"), "older formats are not read") for k in (1, 2, 3, 4, 5, 7, "6 ")},
    **{f"no {key}": ("box", drop(key), f"the key '{key}' is missing") for key in ("robot", "parts", "sha256", "claim", "proof")},
    "an unknown key": ("box", put("note", "and everything else"), "the file: unknown key 'note'"),
    "a witness beside a proof": ("box", put("witness", {"at": ["0", "0"], "limit": "q2.upper"}), "the file: unknown key 'proof'"),
    "no proof but a witness of nothing": ("box", also(drop("proof"), put("witness", None)), "witness: a table is wanted"),
    "another hash": ("box", put("sha256", "0" * 64), "sha256: the hash of the normal form is "),
    "a hash in capitals": ("box", put("sha256", str.upper), "sha256: the hash of the normal form is "),
    "another robot": ("box", put("robot", lambda t: t.replace("[3, 0, 0]", "[3.5, 0, 0]")), "sha256: the hash of the normal form is "),
    "parts that are a list": ("box", put("parts", []), "parts: a table is wanted"),
}  # fmt: skip

CLAIM = {
    **{f"the decimal {x!r}": ("path", put(*POINTS, 0, 1, 0, x), "claim.points[0][1][0]: ") for x in DECIMALS},
    **{f"{x!r} for a decimal": ("path", put(*POINTS, 0, 1, 0, x), "decimal") for x in NO_DECIMALS},
    **{f"no {key} in the claim": ("polygon", drop("claim", key), f"{key}") for key in ("set", "margin", "points", "triangles")},
    **{f"claim.set = {x!r}": ("box", put("claim", "set", x), "claim.set: box or path or polygon or no path is wanted") for x in ("disc", ["box"])},
    "an unknown key of the claim": ("box", put("claim", "note", "safe"), "claim: unknown key 'note'"),
    "a margin below 0": ("box", put("claim", "margin", "-1"), "claim.margin: a number of 0 or more is wanted"),
    "a margin that is not kept": ("box", put("claim", "margin", "4"), "proof.trees[0][0]: the bound of 'floor' fails on a leaf"),
    "an angle of more than five turns": ("box", put(*POINTS, [[["1801", "0"], ["1802", "1"]]]), "claim.points[0][0]: an angle of more than 1800 deg"),
    "an angle of more than 30 radians": ("lift, path", put(*POINTS, 0, 1, 2, "30.01"), "claim.points[0][1]: an angle of more than 30 rad"),
    **{f"claim.points[0][1] = {x!r}": ("path", put(*POINTS, 0, 1, x), "claim.points[0][1]: a list of 2 is wanted") for x in (["1"], ["1", "1", "1"], "11")},
    "no lists": ("path", put(*POINTS, []), "claim.points: a list of 1 to 20000 is wanted"),
    **{f"claim.points[1] = {x!r}": ("path", put(*POINTS, 1, x), "claim.points[1]: a list of 2 to 20000 is wanted") for x in ([], [["0", "-165"]])},
    "a box of two boxes": ("box", put(*POINTS, lambda p: [*p, [["0", "-165"], ["1", "-160"]]]), "claim.points: a list of 1 is wanted"),
    "a box with its high corner first": ("box", put(*POINTS, 0, lambda p: p[::-1]), "claim.points: the first corner is the low one in every joint"),
    "a larger box": ("box", put(*POINTS, 0, 1, 0, "60"), "proof.trees[0][0]: the bound of 'floor' fails on a leaf"),
    "beyond a limit by little": ("up to a limit", put(*POINTS, 0, 1, 1, "170." + "0" * 36 + "1"), "claim: beyond the limit 'q2.upper'"),
    "20,001 configurations": ("path", put(*POINTS, 0, [["0", "0"]] * 20_001), "claim.points[0]: a list of 2 to 20000 is wanted"),
    "20,002 configurations in two lists": ("path", put(*POINTS, [[["0", "0"]] * 10_001] * 2), "claim.points: more than 20000 configurations"),
}  # fmt: skip

TALL = [*SQUARE[:2], ["4", "9"], *SQUARE[2:]]
HOLE = [["2", "2"], ["2", "6"], ["6", "2"]]
POLYGON = {
    "a slit": ("polygon", all_around([[*SQUARE[:2], ["4", "4"], ["8", "0"], *SQUARE[2:]]], HALVES), "claim.points: a loop passes a configuration twice"),
    "a keyhole": ("polygon", all_around([[*SQUARE, SQUARE[0], *HOLE, HOLE[0]]], HALVES), "claim.points: a loop passes a configuration twice"),
    "loops that cancel": ("polygon", all_around([SQUARE, *([["60", "0"], ["68", "0"], ["68", "8"]][::k] for k in (1, -1))], HALVES), "claim.triangles: an edge of the loops is not the edge of one piece alone"),
    "a loop of two": ("polygon", all_around([SQUARE, [["60", "0"], ["68", "0"]]], HALVES), "claim.points[1]: a list of 3 to 20000 is wanted"),
    "a loop twice that is filled once": ("polygon", all_around([SQUARE, SQUARE], HALVES), "an edge of the loops stands there twice"),
    "a loop walked backwards": ("polygon", all_around([SQUARE[::-1]], HALVES), "claim.triangles: a piece is not convex, flat, or goes clockwise"),
    "a corner in no triangle": ("polygon", all_around([TALL], [[0, 1, 3], [0, 3, 4]]), "claim.triangles: an edge of the loops is not the edge of one piece alone"),
    "a triangle left out": ("polygon", all_around([SQUARE], HALVES[:1]), "claim.triangles: an edge of the loops is not the edge of one piece alone"),
    "a triangle twice": ("polygon", all_around([SQUARE], [*HALVES, HALVES[0]]), "claim.triangles: two pieces lie on one side of an edge"),
    "triangles that overlap": ("polygon", all_around([SQUARE], [[0, 1, 2], [3, 0, 1]]), "claim.triangles: two pieces lie on one side of an edge"),
    "a flat triangle": ("polygon", all_around([SQUARE], [*HALVES, [0, 0, 1]]), "claim.triangles: a piece is not convex, flat, or goes clockwise"),
    "a triangle of a corner that is not there": ("polygon", put("claim", "triangles", 0, 0, 4), "claim.triangles[0][0]: 0 to 3 is wanted"),
    "a triangle of the corner before the first": ("polygon", put("claim", "triangles", 0, 2, -2), "claim.triangles[0][2]: 0 to 3 is wanted"),
    "a triangle of truth values": ("polygon", put("claim", "triangles", 0, [False, True, 2]), "claim.triangles[0][0]: 0 to 3 is wanted"),
    "a triangle of four": ("polygon", put("claim", "triangles", 0, [0, 1, 2, 3]), "claim.triangles[0]: a list of 3 is wanted"),
    "no triangles": ("polygon", put("claim", "triangles", []), "claim.triangles: a list of 1 to 20000 is wanted"),
    "a polygon in three joints": ("lift, path", lambda d: d["claim"].update(set="polygon", points=[[["0", "0", "0"], ["0.1", "0", "0"], ["0", "0.1", "0.1"]]], triangles=[[0, 1, 2]]), "claim.points: 3 joints of a polygon vary, not two"),
    "a hole that is printed as an island": ("ring", put(*POINTS, 1, lambda loop: loop[::-1]), "claim.triangles: a piece is not convex, flat, or goes clockwise"),
    "20,001 triangles": ("polygon", put("claim", "triangles", [[0, 1, 2]] * 20_001), "claim.triangles: a list of 1 to 20000 is wanted"),
}  # fmt: skip

SETS = {
    "no directions": ("box", drop("proof", "directions"), "proof: the key 'directions' is missing"),
    "directions that are a table": ("box", put("proof", "directions", {}), "proof.directions: a list of 0 to 20000 is wanted"),
    "a direction of two numbers": ("box", put("proof", "directions", 0, [1, 0]), "proof.directions[0]: a list of 3 is wanted"),
    **{f"proof.directions[0] = {x!r}": ("box", put("proof", "directions", 0, x), "proof.directions[0]: three integers, not all 0, are wanted") for x in ([0, 0, 0], ["1", "0", "0"], [True, False, False])},
    "a direction along the common axis": ("bodies", put("proof", "directions", 0, 2, 1), "proof.trees[1][0]: a direction between bodies has a 0 along the common"),
    **{f"proof.trees[0][0] = {x!r}": ("box", put(*TREES, 0, 0, x), "proof.trees[0][0]: a tree ends before its last leaf") for x in ("a.", "aaa", "", 0)},
    "a tree that goes on": ("box", put(*TREES, 0, 0, ".."), "proof.trees[0][0]: a tree goes on after its last leaf"),
    **{f"letters of proof.trees[0][0]: {x!r}": ("box", put(*TREES, 0, 0, x), "proof.trees[0][0]: no tree of letters and leaves") for x in (". ", ".\n", "A..", "h..")},
    "a joint that is not there": ("box", put(*TREES, 0, 0, "c.."), "proof: a tree cuts a joint that the box does not have, or that has no range"),
    "a joint that is held": ("box of one joint", put(*TREES, 0, 0, "b.."), "proof: a tree cuts a joint that the box does not have, or that has no range"),
    "a fourth edge of a triangle": ("polygon", put(*TREES, 0, 0, "d.."), "proof: a tree cuts an edge that its cell does not have"),
    "121 cuts on top of each other": ("box", put(*TREES, 0, 0, "a" * 121 + "." * 122), "proof.trees[0][0]: more than 120 cuts in a tree"),
    **{f"proof.trees[1][0] = {x!r}": ("box", put(*TREES, 1, 0, x), "proof.trees[1][0]: a leaf names no direction of the list") for x in (".", "1.")},
    **{f"letters of proof.trees[1][0]: {x!r}": ("box", put(*TREES, 1, 0, x), "proof.trees[1][0]: no tree of letters and leaves") for x in ("0.0", "00.", "-1.", "1000000000.", "\u0660.")},
    "a leaf of a half-space with a number": ("box", put(*TREES, 0, 0, "0."), "proof.trees[0][0]: a leaf of a half-space names a direction"),
    **{f"proof.trees[0] = {x!r}": ("path", put(*TREES, 0, x), "proof.trees[0]: a list of 3 is wanted") for x in ("...", [".", "."])},
    "a thing to keep left out": ("box", drop(*TREES, 1), "proof.trees: a list of 2 is wanted"),
    "no trees for a thing to keep": ("box", put(*TREES, 0, []), "proof.trees[0]: a list of 1 is wanted"),
    "trees of two cells exchanged": ("bodies, path", put(*TREES, each(lambda row: row[::-1])), "proof.trees[5][0]: the bound of 'hand, crate' fails on a leaf"),
}  # fmt: skip

SEPARATION = {
    "places that are not there": ("no path", put(*PLACES, []), "proof.tree: a leaf names no place of the list"),
    "a witness of no path": ("no path", also(drop("proof"), put("witness", {"at": ["0"], "limit": "shoulder.lower"})), "witness: a claim of no path has a proof"),
    "too many joints": ("no path", put("claim", "joints", ["moves", "moves"]), "claim.joints: a list of 1 is wanted"),
    "another word for a joint": ("no path, one held", put("claim", "joints", 1, "free"), "claim.joints[1]: moves or held or any is wanted"),
    "no joint that moves": ("no path, one held", put("claim", "joints", ["any", "held"]), "claim.joints: at least one joint moves"),
    "a held joint that has two values": ("no path, one held", put(*POINTS, 0, 1, 1, "-0.2"), "claim.joints: start and goal differ in a joint that is held"),
    "a held joint that moves": ("no path, one held", put("claim", "joints", 1, "moves"), "proof.tree: 'south' is not violated all over a leaf"),
    "a held joint that takes any value": ("no path, one held", put("claim", "joints", 1, "any"), "proof.tree: 'south' is not violated all over a leaf"),
    "a cut of a held joint": ("no path, one held", put(*ROOT, lambda t: f"b{t}{t}"), "proof: a tree cuts a joint that the box does not have, or that has no range"),
    "a cut of a joint of any value": ("no path, any turn", put(*ROOT, lambda t: f"b{t}{t}"), "proof: a tree cuts a joint that the box does not have, or that has no range"),
    "two pairs of start and goal": ("no path", put(*POINTS, lambda p: [*p, *p]), "claim.points: a list of 1 is wanted"),
    "a start beyond a limit": ("no path, sliding", put(*POINTS, 0, 0, 1, "0.3"), "claim.points: the start is beyond a limit"),
    "a goal beyond a limit": ("no path, sliding", put(*POINTS, 0, 1, 1, "-0.8"), "claim.points: the goal is beyond a limit"),
    "a start within a post": ("no path", put(*START, "0"), "proof.tree: the start or the goal is on no open leaf"),
    "a goal within a post": ("no path", put(*GOAL, "180"), "proof.tree: the start or the goal is on no open leaf"),
    "a goal on the start's side some turns on": ("no path", put(*GOAL, "830"), "proof.tree: open leaves lead from the start to the goal"),
    "a start that is the goal": ("no path", put(*GOAL, "70"), "proof.tree: open leaves lead from the start to the goal"),
    "all open": ("no path", put(*ROOT, "."), "proof.tree: open leaves lead from the start to the goal"),
    "a leaf that is opened": ("no path", put(*ROOT, lambda t: re.sub("0[.]", ".", t)), "proof.tree: open leaves lead from the start to the goal"),
    "the leaves at the seam are opened": ("no path", put(*ROOT, lambda t: re.sub("1[.]", ".", t)), "proof.tree: open leaves lead from the start to the goal"),
    "the leaves at the seam are opened, radians": ("no path, radians", put(*ROOT, lambda t: re.sub("1[.]", ".", t)), "proof.tree: open leaves lead from the start to the goal"),
    "the leaves at two seams are opened": ("no path over seams", put(*ROOT, lambda t: t.replace("2.", ".")), "proof.tree: open leaves lead from the start to the goal"),
    "all violated": ("no path", put(*ROOT, "0."), "proof.tree: 'west' is not violated all over a leaf"),
    "a leaf of a place that is not there": ("no path", put(*ROOT, lambda t: t.replace("1.", "2.")), "proof.tree: a leaf names no place of the list"),
    "a free leaf called violated": ("no path", put(*ROOT, lambda t: re.sub("(?<![0-9])[.]", "0.", t, count=1)), "proof.tree: 'west' is not violated all over a leaf"),
    "a thing to keep from the end": ("no path", put(*PLACES, 0, "keep", -2), "proof.places[0].keep: 0 to 1 is wanted"),
    "a thing to keep that is a truth value": ("no path", put(*PLACES, 0, "keep", True), "proof.places[0].keep: 0 to 1 is wanted"),
    "discs about points": ("no path", put(*PLACES, 0, "inside", ["0.1", "0.1"]), "proof.places[0].inside: of bodies only"),
    "one seam in limits of a turn": ("no path in wide limits", in_robot("limits = [-200, 200]", ""), "proof.tree: 'west' is not violated all over a leaf"),
}  # fmt: skip

AT, PLACE = ("witness", "at"), ("witness", "place")
WITNESS = {
    "a witness without a place": ("witness", drop(*PLACE), "witness: the key 'place' is missing"),
    "a witness that is a list": ("witness", put("witness", []), "witness: a table is wanted"),
    "a place and a limit": ("witness", put("witness", "limit", "q2.upper"), "witness: unknown key 'place'"),
    "a witness beside the box": ("witness", put(*AT, 0, "90.1"), "witness.at: not in the box"),
    "a witness of three values": ("witness", put(*AT, ["90", "0.5", "0"]), "witness.at: a list of 2 is wanted"),
    "a witness where all is kept": ("witness", put(*AT, 0, "0"), "witness: 'floor' is not violated there"),
    "a witness of another thing": ("witness", put(*PLACE, {"keep": 1, "near": ["1"], "far": ["1"]}), "witness: 'gap' is not violated there"),
    "a witness of what is not used": ("witness", put(*PLACE, "keep", 2), "witness.place.keep: 0 to 1 is wanted"),
    "a cell of a box": ("witness", put("witness", lambda w: {"cell": 0, "weights": ["0", "1"], "place": w["place"]}), "witness: unknown key 'cell'"),
    "a configuration of a path": ("witness of a cell", put("witness", lambda w: {"at": ["67.5", "0"], "place": w["place"]}), "witness: unknown key 'at'"),
    "a cell from the end": ("witness of a cell", put("witness", "cell", -1), "witness.cell: 0 to 1 is wanted"),
    "a cell that is a text": ("witness of a cell", put("witness", "cell", "1"), "witness.cell: 0 to 1 is wanted"),
    "weights with a sum of nearly 1": ("witness of a cell", put("witness", "weights", ["0.25", "0.7500000000000000000000000000000000001"]), "witness.weights: weights whose sum is 1 are wanted"),
    "a weight below 0": ("witness of a cell", put("witness", "weights", ["-1", "2"]), "witness.weights[0]: a number of 0 or more is wanted"),
    "a weight for no corner": ("witness of a cell", put("witness", "weights", ["0.25", "0.75", "0"]), "witness.weights: a list of 2 is wanted"),
    "a place where a limit is violated": ("limit", put("witness", {"at": ["0", "170.5"], "place": {"keep": 0, "near": [], "far": ["1"]}}), "witness.place: a limit is violated there"),
    "a limit that is kept": ("limit", put(*AT, 1, "170"), "witness.limit: no limit of that name is violated"),
    "another limit": ("limit", put("witness", "limit", "q2.lower"), "witness.limit: no limit of that name is violated"),
    "near weights of a half-space": ("witness", put(*PLACE, "near", ["1"]), "witness.place.near: a list of 0 is wanted"),
    "a place outside its part": ("witness in the crate", put(*PLACE, "near", ["2", "-1", "0", "0"]), "witness.place.near[1]: a number of 0 or more is wanted"),
    "places that are far apart": ("witness in the crate", also(put(*PLACE, "far", ["0", "0", "1", "0"]), put(*PLACE, "near", ["0", "1", "0", "0"]), put(*PLACE, "inside", ["0", "0"])), "witness: 'hand, crate' is not violated there"),
    "a disc beyond its part": ("witness in the crate", put(*PLACE, "inside", ["0.1500001", "0"]), "witness.place.inside: the disc does not lie within the part"),
    "a disc about a corner": ("witness in the crate", put(*PLACE, "inside", ["0.1", "1e-40"]), "witness.place.inside: the disc does not lie within the part"),
    "a disc of a radius below 0": ("witness in the crate", put(*PLACE, "inside", ["0.1", "-0.1"]), "witness.place.inside[1]: a number of 0 or more is wanted"),
    "one disc": ("witness in the crate", put(*PLACE, "inside", ["0.1"]), "witness.place.inside: a list of 2 is wanted"),
    "a disc within a segment": ("witness of a crossing", put(*PLACE, "inside", ["0.01", "0"]), "witness.place.inside: the disc does not lie within the part"),
    "a disc about a point": ("witness of a pair", put(*PLACE, "inside", ["0.1", "0"]), "witness.place.inside: of bodies only"),
    "segments that touch": ("witness of a crossing", put(*AT, ["45"]), "witness: 'rod, wire' is not violated there"),
    "segments seen at a distance": ("witness of a crossing", put("claim", "margin", "1e-40"), "witness: 'rod, wire' is not violated there"),
    "limits of little more than a hundred turns": ("lift", in_robot("limits = [-1, 1]", "limits = [-1, 627.3186]"), "more than 100 turns apart"),
}  # fmt: skip

R = in_robot
FORGED = r'"q\nproved: at every configuration"'
"""A name whose second line looks like an answer."""

JOINT = 'name = "q1", '
ROBOT = {
    **{f"schema = 1 becomes {x!r}": (R("schema = 1", x), "robot: no TOML: ") for x in ("schema = = 1", "schema = 1\nschema = 1")},
    "an unknown key": (R("schema = 1", 'schema = 1\nnote = "safe"'), "robot: unknown key 'note'"),
    "an unknown key of a joint": (R(JOINT, JOINT + 'colour = "red", '), "robot.joint[0]: unknown key 'colour'"),
    "a dotted key": (R("tool =", "home.q3 = 0\ntool ="), "robot: line 6: a key with a dot: 'home.q3 = 0'"),
    "a quoted dotted key": (R("tool =", '"home"."q3" = 0\ntool ='), "robot: line 6: a word follows another word or string: "),
    "a key of ten parts": (R("schema = 1", "schema = 1\na.b.c.d.e.f.g.h.i.j = 1"), "robot: line 2: a word with two dots"),
    "5,000 brackets": (R("schema = 1", "schema = " + "[" * 5000), "robot: more than 8 brackets in each other"),
    "a number of 200 digits": (R("-1.5", "-1." + "5" * 200), "robot: line 16: a word of more than 100 characters: "),
    "a string in two words": (R('"arm"', '"arm" "leg"'), 'robot: line 2: a word follows another word or string: '),
    "a string that does not end": (R('"arm"', '"arm'), "robot: line 2: a string that does not end"),
    **{f"schema = 1 becomes {x!r}, another schema": (R("schema = 1", x), "robot.schema: 1 is wanted") for x in ("schema = true", "schema = 2", "schema = 1.0")},
    "an empty name": (R('"arm"', '""'), "robot.name: a text of 1 to 200 characters is wanted"),
    "another unit of length": (R('"cm"', '"in"'), "robot.length_unit: m or cm or mm is wanted"),
    "another unit of angles": (R('"deg"', '"grad"'), "robot.angle_unit: deg or rad is wanted"),
    "a home without a joint": (R("q1 = 0, ", ""), "robot.home: the key 'q1' is missing"),
    "a joint of lines that look like an answer": (also(R("q1 = 0, q2 = 0", FORGED + ' = "0", q2 = 0'), R('name = "q1"', f"name = {FORGED}")), "robot.home.'q\\nproved: at every configuration': a number is wanted"),
    "a home of a huge number": (R("q2 = 0", "q2 = 1e101"), "robot.home.q2: a number that is not 0 has a size between"),
    "a tool that is no point": (R('tool = "tip"', 'tool = "top"'), "robot: the tool is no point"),
    "an unknown joint": (R('"revolute"', '"screw"'), "robot.joint[0].type: revolute or prismatic or parallelogram or continuous is wanted"),
    "a continuous joint with limits": (R('type = "revolute"', 'type = "continuous", limits = [-1, 1]'), "robot.joint[0]: a continuous joint has no limits"),
    "a parent that is missing": (R('parent = "1"', 'parent = "7"'), "robot.joint[1]: its parent is not the frame before"),
    "one name for two joints": (R('name = "q2"', 'name = "q1"'), "robot: joint: two are called 'q1'"),
    "one name for two frames": (R('frame = "2"', 'frame = "0"'), "robot: frame: two are called '0'"),
    "an origin of two numbers": (R("[0, 0, 2]", "[0, 2]"), "robot.joint[0].origin: a list of 3 is wanted"),
    "an axis of zeros": (R("[0, 1, 0]", "[0, 0.0, 0]"), "robot.joint[0].axis: a direction must not be 0"),
    **{f"[-170, 170] becomes {x!r}": (R("[-170, 170]", x), "robot.joint[1].limits: the first one must be less") for x in ("[170, -170]", "[170, 170]")},
    "limits of more than a hundred turns": (R("[-170, 170]", "[-170, 35830.1]"), "robot.joint[1].limits: more than 100 turns apart"),
    "a slide without limits": (R('"revolute"', '"prismatic"'), "robot.joint[0]: a prismatic joint needs limits"),
    "a velocity of 0": (R(JOINT, JOINT + "velocity = 0, "), "robot.joint[0].velocity: a number of more than 0 is wanted"),
    "a crank without a bar": (R(JOINT, JOINT + "crank = [1, 0, 0], "), "robot.joint[0]: crank and bar belong to a parallelogram"),
    "a mount of more than five turns": (R(JOINT, JOINT + "rpy = [0, 1801, 0], "), "robot.joint[0].rpy: an angle of more than five turns"),
    **{f"-1.5 becomes {x!r}": (R("-1.5", x), "robot.boundary[0].offset: a number is wanted") for x in ('"-1.5"', "true", "1979-05-27")},
    "a number that is nan": (R("-1.5", "nan"), "robot.boundary[0].offset: 'nan' is no decimal number"),
    "a number in other digits": (R("-1.5", "-1.\u0665"), "robot: no TOML: "),
    **{f"-1.5 becomes {x!r}, beyond the sizes": (R("-1.5", x), "robot.boundary[0].offset: a number that is not 0 has a size between") for x in ("-1e-999", "-1e-101", "-1e101")},
    "a clearance below 0": (R("clearance = 0.5", "clearance = -0.5"), "robot.boundary[1].clearance: a number of 0 or more is wanted"),
    "a point of a frame that is missing": (R('frame = "2", at', 'frame = "7", at'), "robot: no frame is called '7'"),
    "a point with the name of a frame": (R('name = "post"', 'name = "1"'), "robot: a point has the name of a frame"),
    "two points of one name": (R('name = "post"', 'name = "tip"'), "robot: point: two are called 'tip'"),
    "a pair of one point": (R('["tip", "post"]', '["tip", "tip"]'), "robot.boundary[1]: two different names are wanted"),
    "a boundary named as the limit of a joint without limits": (R('name = "spare"', 'name = "q1.lower"'), "robot: a boundary has the name of a limit"),
    "a used that is a number": (R("used = false", "used = 0"), "robot.boundary[2].used: True or False is wanted"),
    "an unused boundary that is wrong": (R("used = false", "used = false, clearance = -1"), "robot.boundary[2]: unknown key 'clearance'"),
    "a half-space of two things": (R('point = "tip", n', 'point = "tip", body = "tip", n'), "robot.boundary[0]: a point or a body is wanted"),
    "a half-space of nothing": (R('point = "tip", n', "n"), "robot.boundary[0]: a point or a body is wanted"),
    "an unknown boundary": (R('"half-space"', '"cone"'), "robot.boundary[0].type: pair or bodies or half-space is wanted"),
    "half a character": (R('"arm"', '"\\ud800"'), "robot: no TOML: "),
    "eight joints": (lambda d: d.update(robot=free_joints(8)), "robot.joint: a list of 1 to 7 is wanted"),
    "a robot of more than 500,000 characters": (R("schema = 1", "schema = 1 #" + " " * 500_000), "the file.robot: a text of 1 to 500000 characters is wanted"),
    "a carriage return within a line": (R("schema = 1", "schema = 1\rname = 2"), "robot: line 1: a word follows another word or string: "),
    "a line end of another kind": (R("schema = 1\n", "schema = 1\u2028"), "robot: no TOML: "),
    # what is another robot, for which the proof fails
    "a longer arm": (R("[3, 0, 0]", "[30, 0, 0]"), "proof.trees[0][0]: the bound of 'floor' fails on a leaf"),
    "a larger clearance": (R("clearance = 0.5", "clearance = 5.6"), "proof.trees[1][0]: the bound of 'gap' fails on a leaf"),
    "a limit within the box": (R("[-170, 170]", "[-170, 10]"), "claim: beyond the limit 'q2.upper'"),
    "a boundary that is used after all": (R(", used = false", ""), "proof.trees: a list of 3 is wanted"),
}  # fmt: skip

OF_BODIES = {
    "no parts": (put("parts", {}), "parts: the key 'hook' is missing"),
    "parts of a name of lines": (also(R('name = "hook"', f"name = {FORGED}"), put("parts", {"q\nproved: at every configuration": []})), "parts.'q\\nproved: at every configuration': a list of 1 to 1000 is wanted"),
    "parts of a convex body": (put("parts", "crate", [[0, 1, 2, 3]]), "parts: unknown key 'crate'"),
    "an empty list of parts": (put("parts", "hook", []), "parts.hook: a list of 1 to 1000 is wanted"),
    "a part left out": (put("parts", "hook", lambda p: p[1:]), "parts.hook: an edge of the loops is not the edge of one piece alone"),
    "a part inside out": (put("parts", "hook", 0, lambda part: part[::-1]), "parts.hook: a piece is not convex, flat, or goes clockwise"),
    "a part that is not convex": (put("parts", "hook", [[*range(7)]]), "parts.hook: a piece is not convex, flat, or goes clockwise"),
    "a part of a corner from the end": (put("parts", "hook", 0, 0, lambda k: k - 7), "parts.hook[0][0]: 0 to 6 is wanted"),
    "a part of two corners": (put("parts", "hook", 0, [0, 1]), "parts.hook[0]: a list of 3 to 1000 is wanted"),
    "a part that is a text": (put("parts", "hook", 0, "012"), "parts.hook[0]: a list of 3 to 1000 is wanted"),
    "a larger crate": (R("[[0.6, 0.4], [0.9, 0.4]", "[[0.6, -0.1], [0.9, -0.1]"), "proof.trees[1][0]: the bound of 'upper arm, crate' fails on a leaf"),
    "more clearance": (R("clearance = 0.01", "clearance = 0.3"), "proof.trees[1][0]: the bound of 'upper arm, crate' fails on a leaf"),
    "an obstacle left out": (R('  { name = "pillar", disc = { at = [-0.3, 0.5, 0], radius = 0.1 } },\n', ""), "proof.trees: a list of 7 is wanted"),
    "collisions left out": (R('collisions = "all"\n', ""), "parts: unknown key 'hook'"),
    "other collisions": (R('"all"', '"some"'), "robot.collisions: all is wanted"),
    "more is allowed": (R("allowed = [", 'allowed = [["hand", "crate"], '), "proof.trees: a list of 8 is wanted"),
    "what is not there is allowed": (R('"upper arm", "hand"', '"upper arm", "thumb"'), "allowed: nothing is called 'thumb'"),
    "two shapes": (R("disc =", "polygon = [[0, 0], [1, 0], [0, 1]], disc ="), "robot: a body has one shape: a polygon, a capsule or a disc"),
    "no shape": (R(", disc = { at = [-0.3, 0.5, 0], radius = 0.1 }", ""), "robot: a body has one shape: a polygon, a capsule or a disc"),
    "a corner of four numbers": (R("[0.6, 0.4]", "[0.6, 0.4, 0, 0]"), "robot.obstacle[0].polygon[0]: a list of 2 to 3 is wanted"),
    "an outline without an area": (R("[0.9, 0.7], [0.6, 0.7]", "[0.8, 0.4], [0.7, 0.4]"), "robot: the outline of 'crate' has no area"),
    "an outline that crosses itself": (R("[0.9, 0.7], [0.6, 0.7]", "[0.6, 0.7], [0.9, 0.7]"), "robot: the outline of 'crate' has no area"),
    "two bodies of one name": (R('name = "pillar"', 'name = "crate"'), "robot: body: two are called 'crate'"),
    "a body without a frame": (R('name = "hand", frame = "2"', 'name = "hand"'), "robot.body[1]: the key 'frame' is missing"),
    "a body of a frame that is missing": (R('name = "hand", frame = "2"', 'name = "hand", frame = "7"'), "robot: no frame is called '7'"),
    "a pair of bodies of one frame": (R("boundary = [", 'boundary = [{ name = "x", type = "bodies", bodies = ["crate", "pillar"] },'), "robot.boundary[0]: two bodies of one frame"),
    "a boundary with the name of a pair": (R('name = "floor"', 'name = "hand, crate"'), "robot: boundary: two are called 'hand, crate'"),
    "a skew axis": (R("axis = [0, 0, 1]", "axis = [0, 0.1, 1]"), "robot: bodies keep apart in a plane only, and the arm leaves it"),
    "a mount that leaves the plane": (R("origin = [0.5, 0, 0]", "origin = [0.5, 0, 0], rpy = [0, 9, 0]"), "robot: bodies keep apart in a plane only, and the arm leaves it"),
    "a frame turned askew": (R("origin = [0.5, 0, 0]", "origin = [0.5, 0, 0], rpy = [0, 1e-5, 0]"), "robot: bodies keep apart in a plane only, and the arm leaves it"),
    "bodies of different heights": (R("at = [-0.3, 0.5, 0]", "at = [-0.3, 0.5, 1000]"), "two bodies to keep apart are not at one height"),
    "an outline that leaves its plane": (R("[0.6, 0.4], [0.9, 0.4]", "[0.6, 0.4, 0.1], [0.9, 0.4]"), "two bodies to keep apart are not at one height"),
}  # fmt: skip


REFUSED = {**JSON, **HEAD, **CLAIM, **POLYGON, **SETS, **SEPARATION, **WITNESS}
REFUSED |= {f"a robot with {name}": ("box", *row) for name, row in ROBOT.items()}
REFUSED |= {f"bodies with {name}": ("bodies", *row) for name, row in OF_BODIES.items()}


BULKY = "20,002 configurations in two lists", "20,001 directions"
"""Files that the oracle takes long to refuse."""

FORMAT = (
    "a key twice within",
    "half a character in the robot",
    "a file of more than 4 MB",
)
"""What check.py alone refuses: how JSON may be written."""


@pytest.mark.parametrize(
    ("name", "checker"),
    [(n, c) for n in REFUSED for c in CHECKERS if c == "first" or n not in BULKY + FORMAT],
)
def test_what_the_page_does_not_list_is_refused_in_a_sentence(name, checker):
    start, change, message = REFUSED[name]
    data = changed(start, change)
    assert file_of(data) != json.dumps(original(start))
    refusal = verdict(checker, data)
    assert isinstance(refusal, ValueError), refusal
    assert re.fullmatch("[ -~]+", str(refusal))
    assert not re.search("Error|Exception|fault", str(refusal))
    assert checker != "first" or message in str(refusal)


DIFFERENT = {
    "a 0 with a sign as an index": (
        "polygon", text_of(lambda t: t.replace("[[0, 1, 2]", "[[-0, 1, 2]")), ["", "proved"],
        "The second one takes it for the integer 0."),
    "a robot with a number of 41 digits": (
        "box", in_robot("-1.5", "-1.5" + "0" * 39), ["", "proved"],
        "The page bounds the digits of decimals, and the first one those of the robot too."),
    "a robot with a string on more lines": (
        "box", in_robot('"arm"', '"""arm"""'), ["", "proved"],
        "The first one follows no more of TOML than robots need."),
    "a robot with 400 letters of escapes": (
        "box", in_robot('"arm"', '"' + r"\u0061" * 100 + '"'), ["", "proved"],
        "The first one bounds the text, the second one the string."),
    "a leaf that should be cut": (
        "bodies beside the crate",
        put(*TREES, each(each(lambda tree: tree.strip("abc").split(".")[0] + "."))), ["", "proved"],
        "The second one cuts leaves itself where its bound is the weaker one."),
    "an outline that goes round twice": (
        "bodies",
        in_robot("[0.9, 0.7], [0.6, 0.7]", "[0.9, 0.7], [0.6, 0.7], [0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]"),
        ["proved", ""], "Its hull is that of going round once; the library reads no such robot."),
}  # fmt: skip
"""Files on which the checkers differ, and why that is harmless."""


@pytest.mark.parametrize("name", DIFFERENT)
def test_where_the_checkers_differ_they_are_known_to(name):
    start, change, wanted, _ = DIFFERENT[name]
    data = changed(start, change)
    found = [verdict(checker, data) for checker in CHECKERS]
    assert ["" if isinstance(x, ValueError) else x for x in found] == wanted


# --- the answer -----------------------------------------------------------------------------------


def said(data):
    return check.check(json.dumps(data)).said


def test_the_answer_says_what_was_verified_and_of_what():
    data = original("box")
    assert said(data).splitlines() == [
        f"robot 'arm', sha256 of its normal form {data['sha256']}, not compared with any robot file",
        "proved: at every configuration of the set all of the following is kept",
        "all limits of joints, and with 0 cm to spare each of",
        "  'floor': point 'tip' of frame '2', radius 0.25 cm: at least -1.5 cm of height along (0, 0, 1), in all its places",
        "  'gap': point 'tip' of frame '2', radius 0.25 cm and point 'post' of frame '0': at least 0.5 cm apart",
        "not claimed: 'spare' (used = false)",
        "set: box; 2 configurations ('q1' / deg, 'q2' / deg)",
        "  from low to high: (-10, -20) (8, 12)",
    ]


SAID = {
    "the box is that of the file": ("box", put(*POINTS, 0, 0, ["-1.50e0", "-2"]), "from low to high: (-1.5, -2) (8, 12)"),
    "the margin is that of the file": ("bodies, square", put("claim", "margin", "0.0050"), "with 0.005 m to spare"),
    "bodies by their kinds": ("bodies", None, "'upper arm, pillar': capsule 'upper arm' of frame '1', radius 0.04 m and disc 'pillar' of frame '0', radius 0.1 m: at least 0.01 m apart, seen along the common axis"),
    "what is not claimed of bodies": ("bodies", None, "not claimed: 'upper arm' and 'hand' (allowed), bodies of one frame"),
    "an allowed pair that a boundary is about all the same": ("bodies", lambda _: proved(BODIES.replace("boundary = [", 'boundary = [{ name = "own", type = "bodies", bodies = ["pillar", "hand"] },').replace("allowed = [", 'allowed = [["hand", "pillar"], '), box("-15 -15", "15 15")), "not claimed: 'upper arm' and 'hand' (allowed), bodies of one frame"),
    "two points of no size": ("points that meet", None, "of the following is kept\nall limits of joints\nnot claimed: 'rest': point 'tip' of frame '2' and point 'post' of frame '0': may meet, "),
    "two points of no size on paths": ("points that meet, margin", None, "  'rest': point 'tip' of frame '2' and point 'post' of frame '0': not overlapping\nset:"),
    "no distance": ("segments", None, "not overlapping, seen along the common axis"),
    "a hole": ("ring", None, "  hole: (2, 2) (2, 6) (6, 6) (6, 2)"),
    "an outline": ("ring", None, "set: polygon, 1 outline(s), 1 hole(s); 8 configurations"),
    "islands": ("two squares", None, "set: polygon, 2 outline(s); 8 configurations"),
    "a witness": ("witness", None, "refuted: 'floor' is violated at 'q1' = 90 deg, 'q2' = 0.5 deg"),
    "a limit": ("limit", None, "refuted: the limit 'q2.upper' is violated at 'q1' = 0 deg, 'q2' = 170.5 deg"),
    "no path": ("no path", None, "proved: no path from (70) to (-100) keeps all of the following"),
    "start and goal": ("no path", None, "  from start to goal: (70) (-100)"),
    "joints on paths": ("no path, any slide", None, "'shoulder' moves\n  'elbow' takes any value, even jumps"),
    "a joint that is held": ("no path, one held", None, "'elbow' is held"),
    "a name that would end the quotes": ("box", in_robot('name = "arm"', 'name = "a\', proved"'), '"a\', proved"'),
    "a name that would steer a terminal": ("box", in_robot('"arm"', r'"\u001b[2J proved"'), r"'\x1b[2J proved'"),
}  # fmt: skip


@pytest.mark.parametrize("name", SAID)
def test_the_answer_names_what_the_file_says(name):
    start, change, line = SAID[name]
    assert line in said(changed(start, change or (lambda _: None)))


@pytest.mark.parametrize("name", ["a\nproved: b", "a\r\x1b[2Jproved: b", "a\u2028proved: b"])
def test_a_refusal_is_one_line_whatever_the_file_is_called(name, tmp_path, capsys):
    """A name with line ends printed "proved: ..." as the first words of a line."""
    assert check.main([str(tmp_path / name)]) == check.NO_ANSWER
    refusal = str(check.Refused(f"{name} is no robot"))
    for said in (capsys.readouterr().out[:-1], refusal):
        assert re.fullmatch("[ -~]+", said)


def test_a_long_path_is_named_by_its_ends_its_ranges_and_a_hash_of_all_its_places():
    """By the ranges alone, two paths had one printed answer, which read as start and end."""
    places = [f"{k % 7} {k}" for k in range(51)]
    other = [*places[:20], "5.5 20", *places[21:]]
    one, two = (said(proved(FREE, path(", ".join(row)))) for row in (places, other))
    printed = " ".join(f"({q.replace(' ', ', ')})" for q in places)
    page = "written as the page of the format says, their sha256 is "
    assert f"{page}{hashlib.sha256(printed.encode()).hexdigest()}" in one
    assert "path from (0, 0) to (1, 50)" in one
    assert "'q1' is between 0 and 6 deg in the set" in one
    assert one != two


@pytest.mark.parametrize(("shift", "angle"), [(0, True), (1, False), (-180, True)])
def test_that_a_joint_takes_every_angle_is_said_where_it_does_so_without_a_gap(shift, angle):
    """Two islands that do not touch go round in their ranges only."""
    low = [["-180", "0"], ["0", "0"], ["0", "8"], ["-180", "8"]]
    high = [[str(int(x) + 180 + shift), y] for x, y in low]
    both = polygon([low, high], [*HALVES, *([i + 4 for i in row] for row in HALVES)])
    if not shift:
        both = polygon([[low[0], high[1], high[2], low[3]]], HALVES)
    free = FREE.replace(", limits = [-170, 170]", "")
    if shift == -180:
        both = path("-180 0, 180 0")
    assert ("'q1' takes every angle" in said(proved(free, both))) == angle


def test_the_answer_speaks_in_the_words_of_the_robot_file_that_is_given():
    """Names of points are no part of the normal form: a forger may choose them."""
    data = changed("box", lambda d: put("robot", d["robot"].replace('"post"', '"pillow"'))(d))
    assert "point 'pillow'" in check.check(json.dumps(data)).said
    told = check.check(json.dumps(data), ARM, "arm.toml").said
    assert "point 'post' of frame '0': at least 0.5 cm apart" in told
    assert "pillow" not in told


@pytest.mark.parametrize("places", [30, 38])
def test_a_violation_in_the_last_digits_is_one(places):
    for digit, wanted in (("1", "refuted"), ("0", "")):
        robot = ARM.replace(", radius = 0.25", "").replace("-1.5", f"2.{'0' * places}{digit}")
        at = {"at": ["0", "0"], "place": {"keep": 0, "near": [], "far": ["1"]}}
        data = Draft(robot, box("0 0", "0 0")).file(witness=at)
        assert verdict("second", data) == wanted or not wanted
        assert verdict("first", data) == wanted or not wanted


# --- the command ----------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    """A folder with a copy of the checker, certificates and robot files."""
    (tmp_path / "check.py").write_bytes(FILE.read_bytes())
    for name in ("box", "witness"):
        (tmp_path / f"{name}.json").write_text(json.dumps(original(name)))
    (tmp_path / "wrong.json").write_text(json.dumps(original("box") | {"sha256": "0" * 64}))
    robots = {
        "same": ARM,
        "dos": "\ufeff" + ARM.replace("\n", "\r\n"),
        "words": "# mine\n" + ARM.replace("[3, 0, 0]", "[3.0, 0, -0.0]"),
        "other": ARM.replace("[3, 0, 0]", "[3.1, 0, 0]"),
        "none": "hello",
        "huge": "#" * 5_000_000,
    }
    for name, text in robots.items():
        (tmp_path / f"{name}.toml").write_bytes(text.encode())
    (tmp_path / "latin.toml").write_bytes(ARM.encode() + b"# \xe9")
    return tmp_path


def run(folder, *words, **options):
    command = [sys.executable, "-I", "check.py", *words]
    options = {"capture_output": True, "timeout": 60} | options
    return subprocess.run(command, cwd=folder, text=True, check=False, **options)


COMMANDS = {
    "box.json": (0, "proved"),
    "witness.json": (3, "refuted"),
    "wrong.json": (2, "not proved: sha256"),
    "box.json --robot same.toml": (0, "compared with 'same.toml': the same"),
    "box.json --robot dos.toml": (0, "compared with 'dos.toml': the same"),
    "box.json --robot words.toml": (0, "compared with 'words.toml': the same"),
    "witness.json --robot same.toml": (3, "compared with 'same.toml': the same"),
    "box.json --robot other.toml": (2, "not proved: the robot is not that of 'other.toml'"),
    "box.json --robot none.toml": (2, "not proved: the robot is not that of 'none.toml': robot: no TOML"),
    "box.json --robot latin.toml": (2, "not UTF-8"),
    "box.json --robot huge.toml": (2, "more than"),
    "box.json --robot nothing.toml": (2, "cannot be read"),
    "box.json --robot": (2, "usage"),
    "box.json --robot ''": (2, "usage"),
    "box.json --sha256 0": (2, "usage"),
    "box.json --robot same.toml --print robot": (2, "usage"),
    "box.json --print all": (2, "usage"),
    "box.json --print robot": (0, '"keep": ['),
    "wrong.json --print robot": (2, "not proved: sha256"),
    "nothing.json": (2, "cannot be read"),
    ".": (2, "cannot be read"),
    "''": (2, "usage"),
    "--robot": (2, "usage"),
    "": (2, "usage"),
    "--help": (0, "usage"),
    "--version": (0, "qbound/certificate/6"),
}  # fmt: skip


@pytest.mark.parametrize("words", COMMANDS)
def test_the_status_is_0_proved_3_refuted_2_anything_else(folder, monkeypatch, capsys, words):
    monkeypatch.chdir(folder)
    status, text = COMMANDS[words]
    assert check.main(shlex.split(words)) == status
    out = capsys.readouterr().out
    assert text in out
    assert out.isascii()
    assert (status == 2) == (out.startswith("not proved: "))


def test_the_file_runs_alone_anywhere(folder):
    for words, status in (
        ("box.json --robot same.toml", 0),
        ("witness.json", 3),
        ("wrong.json", 2),
    ):
        done = run(folder, *words.split())
        assert (done.returncode, done.stderr) == (status, "")


@pytest.mark.parametrize("seed", range(30))
def test_the_library_reads_the_same_robot(seed):
    names = packaged_robots()
    robot = robot_text(names[seed])[0] if seed < len(names) else robot_file(seed, 4, ALL_KINDS)
    assert second_checker.normal_form(robot, {}) == check.normal_form(robot, {})


def test_the_normal_form_that_is_printed_has_the_hash_of_the_file(folder):
    printed = run(folder, "box.json", "--print", "robot").stdout
    assert check.digest(printed) == original("box")["sha256"]
    form = json.loads(printed)
    assert [row["name"] for row in form["keep"]] == ["floor", "gap"]
    assert form["keep"][1] == {"name": "gap", "near": 1, "far": 0, "gap": "0.75", "along": None}
    assert form["hulls"] == [
        {"frame": 2, "corners": [["2", "0", "0"]]},
        {"frame": 0, "corners": [["0", "0", "4.5"]]},
    ]


BESIDE = ["__future__", "dataclasses", "fractions", "hashlib", "json", "math", "re", "tomllib", "typing"]  # fmt: skip


@pytest.mark.parametrize("option", [["-I"], []])
def test_modules_beside_the_checker_do_not_answer_for_it(folder, option):
    """Python looks for modules in the folder of a script first, unless it runs with -I."""
    for name in BESIDE:
        (folder / f"{name}.py").write_text("import os\nos._exit(0)\n")
    words = [sys.executable, *option, folder / "check.py", folder / "wrong.json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout[:12]) == (2, "not proved: ")


def test_an_older_python_has_no_answer_and_not_the_status_of_one():
    """It ended with 1, by an exception, when that meant refuted."""
    ast.parse(FILE.read_text(encoding="utf-8"), feature_version=(3, 8))
    older = "import runpy, sys; sys.version_info = (3, 10, 12); runpy.run_path(sys.argv[1])"
    words = [sys.executable, "-I", "-c", older, FILE]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "")
    assert done.stdout == "not proved: check.py needs Python 3.11 or newer\n"
    assert 1 not in (check.PROVED, check.REFUTED, check.NO_ANSWER)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_an_answer_that_cannot_be_printed_is_no_proof(folder):
    with Path("/dev/full").open("w") as full:
        done = run(folder, "box.json", capture_output=False, stdout=full, stderr=subprocess.PIPE)
    assert (done.returncode, done.stderr) == (2, "")
    words = f"{sys.executable} -I check.py box.json >&-"
    done = subprocess.run(words, shell=True, cwd=folder, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (2, b"")


def test_names_in_any_script_reach_any_terminal(folder):
    (folder / "box.json").write_text(json.dumps(changed(*ACCEPTED["a name in another script"])))
    done = run(folder, "box.json", env={"PYTHONIOENCODING": "ascii", "LC_ALL": "C"})
    assert (done.returncode, done.stderr) == (0, "")
    assert r"'Gr\xf6\xdfe \u202e \U0001f916'" in done.stdout


CRASHES = {
    KeyboardInterrupt: 130, RecursionError: 2, MemoryError: 2, ZeroDivisionError: 2, KeyError: 2,
    AssertionError: 2, OverflowError: 2,
}  # fmt: skip


@pytest.mark.parametrize("fault", CRASHES)
def test_whatever_happens_no_crash_is_an_answer(folder, monkeypatch, capsys, fault):
    def crash(*_):
        raise fault("inside")

    monkeypatch.setattr(check, "read_robot", crash)
    assert check.main([str(folder / "box.json")]) == CRASHES[fault]
    out = capsys.readouterr().out
    assert out.startswith("not proved: ")
    assert fault.__name__ not in out


# --- hostile files --------------------------------------------------------------------------------


def with_text(text):
    return original("box") | {"robot": text}


def with_tree(name, *place, tree):
    data = original(name)
    put(*place, tree)(data)
    return data


def balanced(depth, letters="ab"):
    return "." if not depth else letters[depth % len(letters)] + balanced(depth - 1, letters) * 2


def colliding(count):
    """A path along decimals whose values all have one hash; nothing is to be kept."""
    data = Draft(FREE, path("0 0, 1 1")).file()
    data["claim"]["points"] = [[[f"{k * (2**61 - 1)}e-20", "0"] for k in range(1, count + 1)]]
    return data | {"proof": {"directions": [], "trees": []}}


def long_outline(count=1000):
    """An outline of many corners, not convex, with as many digits as may be."""
    x = [f"{0.6 + 0.0003 * k:.4f}{'1' * 35}" for k in range(count // 2)]
    loop = [f"[{a}, {0.4 + (float(a) - 0.7) ** 2 / 2:.9f}]" for a in x] + [
        f"[{a}, 0.9]" for a in x[::-1]
    ]
    crate = "[[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]]"
    return with_text(BODIES.replace(crate, f"[{', '.join(loop)}]"))


def obstacles(count):
    disc = '{{ name = "o{}", disc = {{ at = [9, 9, 0], radius = 0.1 }} }},\n'
    return with_text(
        BODIES.replace("obstacle = [", "obstacle = [" + "".join(map(disc.format, range(count))))
    )


def free_joints(count, boundaries=0):
    """The text of an arm of many joints without limits, beside far walls."""
    joint = '[[joint]]\nname = "q{0}"\ntype = "revolute"\nparent = "{0}"\nframe = "{1}"\norigin = [1, 0, 0]\naxis = [{2}, 1, 1]\n'
    wall = '[[boundary]]\nname = "w{}"\ntype = "half-space"\npoint = "tip"\nnormal = [0, 0, 1]\noffset = -99\n'
    home = ", ".join(f"q{j} = 0" for j in range(count))
    rows = [joint.format(j, j + 1, j % 2) for j in range(count)]
    rows += [
        f'[[point]]\nname = "tip"\nframe = "{count}"\nat = [1, 0, 0]\n',
        *map(wall.format, range(boundaries)),
    ]
    return ARM.split("joint = [")[0].replace("q1 = 0, q2 = 0", home) + "".join(rows)


def walls(count, letters):
    trees = [["a" * letters + "." * (letters + 1)]] * count
    draft = Draft(free_joints(6, count), box(" ".join("0" * 6), " ".join("1" * 6)))
    return draft.file(proof={"directions": [], "trees": trees})


def seams(depth):
    draft = Draft(free_joints(7), {"set": "no path"} | between("1 " * 7, "2 " * 7, "moves " * 7))
    return draft.file(proof={"places": [], "tree": balanced(depth, "abcdefg")})


def long_names(count=138):
    """Twenty thousand pairs of parts with long names: a normal form of 90 MB of ASCII."""
    x = [k / count - 0.5 for k in range(count)]
    loop = [[0, 1], *([round(u, 4), round(0.5 - u * u, 8)] for u in x)]
    fan = [[0, k, k + 1] for k in range(1, count)]
    moved_loop = [[0.75 + u, round(0.4 + v, 8)] for u, v in loop]
    robot = BODIES.replace("[[0.4, 0.03], [0.4, -0.03], [-0.05, -0.03], [-0.05, 0.03]]", str(loop))
    robot = robot.replace("[[0.6, 0.4], [0.9, 0.4], [0.9, 0.7], [0.6, 0.7]]", str(moved_loop))
    names = {name: "\U0001f916" * 190 + name for name in ("hand", "crate")}
    for name, long_name in names.items():
        robot = robot.replace(f'"{name}"', f'"{long_name}"')
    robot = re.sub('  { name = "hook".*\n', "", robot)
    parts = dict.fromkeys(names.values(), fan)
    return Draft(robot, box("0 0", "0 0"), parts).file(proof={"directions": [], "trees": []})


HOSTILE = {
    "long names of many pairs": long_names,
    "equal hashes of 20,000 configurations": lambda: colliding(20_000),
    "outlines of a thousand corners": long_outline,
    "a thousand obstacles": lambda: obstacles(1900),
    "a tree of a million leaves": lambda: with_tree("box", *TREES, 0, 0, tree="a" * 1_000_000 + "." * 1_000_001),
    "a deep tree of open leaves": lambda: with_tree("no path over seams", *ROOT, tree="a" * 120 + "." * 121),
    "a long dotted key": lambda: with_text("a." * 200_000 + "a = 1"),
    "dotted keys in a table": lambda: with_text("a = {" + "a." * 200_000 + "a = 1}"),
    "a long dotted header": lambda: with_text("[" + "a." * 200_000 + "a]"),
    "quoted dotted keys": lambda: with_text("'a'." * 100_000 + "a = 1"),
    "a long key": lambda: with_text("a" * 400_000 + " = 1"),
    "a long number": lambda: with_text("a = " + "1" * 400_000),
    "a long string": lambda: with_text("a = '" + "1" * 400_000),
    "many keys": lambda: with_text("".join(f"a{k} = 1\n" for k in range(40_000))),
    "many tables": lambda: with_text("[[joint]]\n" * 45_000),
    "deep TOML": lambda: with_text("a = " + "[" * 100_000),
    "many quotes": lambda: with_text('"' * 400_000),
    "many backslashes": lambda: with_text('a = "' + "\\" * 400_000),
    "a file without an end": lambda: None,
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_answered_in_bounded_time_and_memory(tmp_path, name):
    data, file = HOSTILE[name](), tmp_path / "hostile.json"
    file.write_text(json.dumps(data), encoding="utf-8")

    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (500_000_000, 500_000_000))
        resource.setrlimit(resource.RLIMIT_CPU, (30, 30))

    for option in ([], ["--print", "robot"]):
        words = [sys.executable, "-I", FILE, file if data else "/dev/zero", *option]
        done = subprocess.run(words, preexec_fn=limits, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) in ((0, ""), (2, ""))
        assert not re.search("Error|Exception|Traceback|fault of the checker|memory", done.stdout)


COSTLY = {
    "two thousand walls of six joints": lambda: walls(2000, 0),
    "many walls and deep trees": lambda: walls(300, 119),
    "a wide tree": lambda: with_tree("box", *TREES, 0, 0, tree=balanced(19)),
    "a wide tree of open leaves": lambda: with_tree("no path over seams", *ROOT, tree=balanced(14)),
    "seams of seven joints": lambda: seams(10),
}  # fmt: skip


@pytest.mark.parametrize("name", COSTLY)
def test_work_is_counted_before_it_is_done(monkeypatch, name):
    """With a hundredth of the work that is allowed, all of these end early."""
    monkeypatch.setattr(check.Work, "MOST", check.Work.MOST // 200)
    assert "too much work" in str(verdict("first", COSTLY[name]()))
    assert check.Work.done <= 1.5 * check.Work.MOST


def test_the_work_of_a_file_is_always_the_same():
    done = []
    for name in ("bodies", "box", "bodies"):
        verdict("first", original(name))
        done.append(check.Work.done)
    assert done[0] == done[2] > done[1]


def test_the_bounds_of_the_page_are_those_of_the_checker():
    page = (Path(__file__).parents[2] / "book/certificate.md").read_text(encoding="utf-8")
    for bound in (check.MAX_FILE, check.MAX_ROBOT, check.MAX_CELLS, check.MAX_BOUNDARIES):
        assert f"{bound:,}" in page
    for bound in (f"{check.MAX_JOINTS} joints", f"At most {check.MAX_DEPTH} cuts"):
        assert bound in page
    assert "1,800 degrees or 30 radians" in page
    assert check.LARGEST_ANGLE == {"deg": 1800, "rad": 30}
    bits = math.log2(check.SLACK / check.ONE)
    assert f"2<sup>-{check.BITS}</sup>" in page
    assert f"2<sup>{bits:.0f}</sup>" in page
