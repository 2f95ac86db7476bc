# ruff: noqa: E501  (a table of faults, one a line)
"""The search over boxes and polygons: no false proof, few leaves, faults seen by the checker."""

import tomllib
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from cspace import check
from cspace.boundary.functions import clearance, margin_of
from cspace.model.robotfile import parse_robot, robot_text
from cspace.proofs import subdivide
from cspace.proofs.certificates import certify as prover
from cspace.proofs.certificates import inequality, statements, witness
from cspace.proofs.certificates import search as safe
from cspace.proofs.certificates.certify import Subject, certify
from cspace.proofs.certificates.inequality import BoundedArm, ChainStep, Seen
from cspace.proofs.subdivide import Boxes, Forest, Simplices
from cspace.urdf.arm import import_urdf
from cspace.urdf.arm import robot_text as urdf_text
from engine_support import body_scenes, brute_force, second_checker
from engine_support.robot_files import robot_file
from engine_support.six_joints import around_home, six_joint_arm

PLANES = [*body_scenes.PLANES]


def least_margins(robot, low, high, seed):
    """Return the smallest margin of each boundary at random places and at corners of a box: upper bounds."""
    rng = np.random.default_rng(seed)
    low, high = np.array(low, float), np.array(high, float)
    shares = np.concatenate([rng.random((4000, len(low))), rng.integers(0, 2, (4000, len(low)))])
    q = (low + shares * (high - low)) * statements.units(robot)
    return {
        boundary.name: float(margin_of(robot, boundary, clearance(robot, boundary)(q)).min())
        for boundary in robot.boundaries
    }


@cache
def tight_arm(half, room=0.01):
    """Return an arm all of whose boundaries are nearly reached in the box about home."""
    robot = parse_robot(tomllib.loads(six_joint_arm()))
    least = least_margins(robot, *around_home(half), seed=half)
    return six_joint_arm({name: margin - room for name, margin in least.items()})


def both_checkers(text):
    """Return what checker and oracle say; they say the same."""
    refuted = check.check(text).refuted
    answer = second_checker.verify(text)
    assert refuted == (answer == "refuted")
    return answer


# --- answers --------------------------------------------------------------------------------------


def test_five_degrees_about_home_of_six_joints_are_proved_by_one_leaf_a_boundary():
    answer = certify(six_joint_arm(), statements.box(*around_home(5)))
    assert answer.verdict == both_checkers(answer.text) == "proved"
    assert answer.leaves == len(answer.searches) == 10


def test_all_pairs_of_an_imported_arm_of_seven_joints_are_proved():
    """114 pairs of balls of the Panda within 5 degrees of its home: one leaf each."""
    text = urdf_text(import_urdf("panda.urdf", srdf="panda.srdf", excess=0.02))
    home = (0, -45, 0, -135, 0, 90, 45)
    ends = ([str(q + step) for q in home] for step in (-5, 5))
    answer = certify(text, statements.box(*ends))
    assert answer.verdict == both_checkers(answer.text) == "proved"
    assert answer.leaves == len(answer.searches) == 114


@pytest.mark.parametrize("half", [5, 20])
def test_boundaries_that_are_nearly_reached_are_proved_and_reached_ones_are_refuted(half):
    """A hundredth of a metre is left of each; a margin of a little more is not kept."""
    text, ends = tight_arm(half), around_home(half)
    answer = certify(text, statements.box(*ends))
    assert answer.verdict == both_checkers(answer.text) == "proved"
    assert answer.leaves < 700
    answer = certify(text, statements.box(*ends, "0.011"))
    assert answer.verdict == both_checkers(answer.text) == "refuted"
    low, high = (np.array(end, float) for end in ends)
    assert ((low <= answer.witness.q) & (answer.witness.q <= high)).all()
    assert answer.witness.depth > 0.0009


def test_cutting_where_it_helps_most_takes_fewer_leaves_than_the_longest_edge(monkeypatch):
    text, statement = tight_arm(10), statements.box(*around_home(10))
    few = certify(text, statement).leaves

    def longest(self, kind, rows, cells, seen):
        return cells.halfwidths.argmax(axis=1)

    monkeypatch.setattr(safe._Judge, "_cuts", longest)
    assert certify(text, statement).leaves > 1.5 * few


@pytest.mark.parametrize("kinds", ["RR", "PR", "PP"])
def test_bodies_are_proved_or_refuted_and_both_checkers_agree(kinds):
    """Bodies of all shapes, in any plane: a box, a path and a triangle of each scene."""
    found = []
    for seed in range(15):
        text = body_scenes.ordinary(seed, kinds, PLANES[seed % 3])
        units = np.array([100 if kind == "R" else 1 for kind in kinds])
        rng = np.random.default_rng(seed)
        low = rng.uniform(-1, 0.5, 2) * units
        a, b, c = (
            [f"{x:.3f}" for x in low + step * units] for step in ([0, 0], [0.1, 0], [0.1, 0.1])
        )
        for statement in (
            statements.box(a, c),
            statements.path([a, b, c], "0.01"),
            statements.filled([[a, b, c]]),
        ):
            answer = certify(text, statement)
            assert both_checkers(answer.text) == answer.verdict
            found.append(answer.verdict)
    assert {*found} == {"proved", "refuted"}


def test_a_parallelogram_has_certificates():
    text = """schema = 1
name = "lift"
length_unit = "m"
angle_unit = "rad"
home = { lift = 0, swing = 0 }
tool = "fork"
joint = [
  { name = "lift", type = "parallelogram", parent = "0", bar = "bar", frame = "1", origin = [0, 0, 1], axis = [0, 1, 0], crank = [2, 0, 0], limits = [-1.2, 1.2] },
  { name = "swing", type = "revolute", parent = "1", frame = "2", origin = [0, 0, 0], axis = [0, 0, 1] },
]
point = [
  { name = "fork", frame = "2", at = [0.5, 0, 0], radius = 0.1 },
  { name = "elbow", frame = "bar", at = [1, 0, 0.2] },
  { name = "pole", frame = "0", at = [2.2, 0.4, 3], radius = 0.2 },
]
boundary = [
  { name = "fork, pole", type = "pair", points = ["fork", "pole"] },
  { name = "fork, elbow", type = "pair", points = ["fork", "elbow"], clearance = 0.1 },
  { name = "floor", type = "half-space", point = "fork", normal = [0, 0, 1], offset = 0.2 },
]
"""
    answer = certify(text, statements.box(["-0.4", "-0.5"], ["0.2", "0.5"]))
    assert answer.verdict == both_checkers(answer.text) == "proved"
    answer = certify(text, statements.box(["-0.4", "-0.5"], ["0.5", "0.5"]))
    assert answer.verdict == both_checkers(answer.text) == "refuted"


# --- the inequality -------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_the_bound_is_below_every_margin_and_close_to_it_on_small_boxes(seed):
    joints = 1 + seed % 7
    text = robot_file(seed, joints)
    arm, table = BoundedArm(Subject(text).form), tomllib.loads(text)
    rng = np.random.default_rng(seed)
    centre = rng.uniform(-3, 3, joints)
    for size in (1e-4, 0.3, 3.0):
        half = size * rng.random(joints)
        q = centre + half * rng.uniform(-1, 1, (500, joints))
        margins = brute_force.margins(table, {"margin": "0"}, q)
        cell = Boxes((centre * arm.units)[None], (half * arm.units)[None])
        for k, name in enumerate(arm.names):
            kind, rows = arm.kinds[arm.kind_of[k]], arm.row_of[[k]]
            [value] = arm.seen(kind, rows, cell).refined(cell)[1]
            assert value <= margins[name].min() + 1e-9
            if size == 1e-4:
                assert value == pytest.approx(margins[name].min(), abs=1e-2)
            [shown] = witness.violated(
                arm, kind, rows, cell, witness.contacts(arm, kind, rows, cell)
            )
            assert shown <= -margins[name].max() + 1e-9


# --- faults in the search -------------------------------------------------------------------------


def files(text, statement):
    """Return the file that the search alone would write; None if even the search does not believe it."""
    subject = Subject(text)
    arm = prover.BoundedArm(subject.form, prover.Fraction(statement["margin"]))
    found, directions = safe.search(arm, prover.cells_of(arm, statement), 20_000)
    if any(each.left or each.violation is not None for each in found.values()):
        return None
    return subject.written(statement, proof=prover.proof_of(arm, found, directions))


@cache
def asked():
    """Statements and what is true of them: of some everything is kept by far, or not by little."""
    text, _ = robot_text("minervabot-v2")
    robot = parse_robot(tomllib.loads(text))
    scales = ((0.96, "0"), (0.9, "2.3"), (0.9, "2.7"), (0.97, "0"), (1, "0"))
    rows = [(text, statements.home_polygon(robot, *each)) for each in scales]
    ends = around_home(10)
    rows += [(tight_arm(10), statements.box(*ends, x)) for x in ("0", "0.005", "0.011", "0.03")]
    return [(*row, certify(*row).verdict) for row in rows]


def exchanged(halves):
    def fault(self, cuts):
        found = halves(self, cuts)
        return found[np.arange(len(found)).reshape(-1, 2)[:, ::-1].ravel()]

    return fault


def third(self, cuts):
    """Cut at a third of the edge instead of its middle."""
    i, k = (ends[cuts] for ends in np.triu_indices(self.corners.shape[1], 1))
    rows, halves = np.arange(len(self)), np.repeat(self.corners, 2, axis=0)
    place = (2 * self.corners[rows, i] + self.corners[rows, k]) / 3
    halves[2 * rows, k], halves[2 * rows + 1, i] = place, place
    return Simplices(halves)


def half_of_the_box(arm, statement):
    cells = CELLS(arm, statement)
    return cells if isinstance(cells, Simplices) else Boxes(cells.centres, cells.halfwidths / 2)


def an_arm(**changes):
    def made(form, margin):
        arm = BoundedArm(form, margin)
        for name, change in changes.items():
            setattr(arm, name, change(getattr(arm, name)))
        return arm

    return made


BEND, TURNED, NAMED = inequality._bend, ChainStep.turned, safe.Directions.named
LEAST, LEAST_OF_SIMPLICES, CELLS = Boxes.least, Simplices.least, prover.cells_of
CUT, TREE = Forest.cut, Forest._tree

FAULTS = {
    "half the bending": (inequality, "_bend", lambda *x: BEND(*x) / 2),
    "the value in the middle": (Seen, "kept", lambda self, u, cells: self.margins(u)),
    "half the slope of boxes": (Boxes, "least", lambda self, s: LEAST(self, s) / 2),
    "no slope of triangles": (Simplices, "least", lambda self, s: 0 * LEAST_OF_SIMPLICES(self, s)),
    "turns too little": (ChainStep, "turned", lambda self, angle: TURNED(self, 0.96 * angle)),
    "halves of boxes exchanged": (Boxes, "halves", exchanged(Boxes.halves)),
    "halves of triangles exchanged": (Simplices, "halves", exchanged(Simplices.halves)),
    "cut at a third": (Simplices, "halves", third),
    "the next letter": (Forest, "cut", lambda self, n, e: CUT(self, n, (e + 1) % 3)),
    "a leaf left out": (Forest, "_tree", lambda self, root: TREE(self, root)[:-1]),
    "a leaf too many": (Forest, "_tree", lambda self, root: TREE(self, root) + "."),
    "one tree for all": (Forest, "_tree", lambda self, root: TREE(self, 0)),
    "a root off by one": (Forest, "_tree", lambda self, root: TREE(self, (root + 1) % self.size)),
    "another direction": (safe.Directions, "named", lambda self, *x: [leaf and f"{(int(leaf[:-1]) + 1) % len(self.rows)}." for leaf in NAMED(self, *x)]),
    "directions that are rounded too far": (safe.Directions, "named", lambda self, *x: NAMED(self, *x[:-1], -1e9)),
    "a part of the box": (prover, "cells_of", half_of_the_box),
    "degrees off": (prover, "BoundedArm", an_arm(units=lambda units: units * 0.97)),
    "a longer link": (prover, "BoundedArm", an_arm(steps=lambda steps: [*steps[:-1], replace(steps[-1], origin=1.1 * steps[-1].origin)])),
    "the margin ignored": (prover, "BoundedArm", lambda form, margin: BoundedArm(form)),
    "a thing forgotten": (prover, "BoundedArm", an_arm(needed=lambda needed: [*needed[:-1], False])),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_both_checkers_see_a_fault_of_the_search(monkeypatch, name):
    place, attribute, fault = FAULTS[name]
    asked_for = asked()
    monkeypatch.setattr(place, attribute, fault)
    written = [(files(*row), true) for *row, true in asked_for]
    monkeypatch.undo()
    seen = 0
    for file, true in written:
        if file is None:
            continue
        try:
            check.check(file)
        except ValueError:
            seen += 1
        else:
            assert true == "proved"  # lucky, but right
        try:
            second_checker.verify(file)
        except ValueError:
            continue
        assert true == "proved"  # it has a bound of its own
    assert seen


def test_without_a_fault_the_checkers_agree_with_the_search():
    found = [(files(*row), true) for *row, true in asked()]
    assert {true for _, true in found} == {"proved", "refuted"}
    for file, true in found:
        assert (file is not None) == (true == "proved")
        assert file is None or both_checkers(file) == "proved"


def test_a_search_that_ends_early_says_what_is_left():
    text, statement, _ = asked()[0]
    arm = BoundedArm(Subject(text).form)
    found, _ = safe.search(arm, prover.cells_of(arm, statement), 3)
    assert any(each.left and 0 < each.part_left <= 1 for each in found.values())
    assert isinstance(found[0], subdivide.Search)
