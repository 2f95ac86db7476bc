# ruff: noqa: E501  (a table of faults, one a line)
"""Boxes in up to six joints: one cell, halved where it bends most; no false proof, faults seen."""

import json
import tomllib

import numpy as np
import pytest

from qbound import check
from qbound.boundary.functions import clearance, margin_of
from qbound.model.robotfile import parse_robot
from qbound.proofs import boxes, check_arb, statements
from qbound.proofs import certify as prover
from qbound.proofs.certify import certify
from qbound.proofs.forest import Forest
from support.robot_files import box_of, robot_file
from support.six_joints import around_home, six_joint_arm


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


def tight_arm(half, room=0.01):
    """Return an arm all of whose boundaries are nearly reached in the box about home."""
    robot = parse_robot(tomllib.loads(six_joint_arm()))
    least = least_margins(robot, *around_home(half), seed=half)
    return six_joint_arm({name: margin - room for name, margin in least.items()})


def both_checkers(text):
    """Return what both checkers say; they say the same."""
    refuted = check.check(text)[0]
    answer = check_arb.verify(text)
    assert refuted == (answer == "refuted")
    return answer


def test_five_degrees_about_home_of_six_joints_are_proved_by_one_cell_a_boundary():
    text = six_joint_arm()
    answer = certify(text, statements.box(*around_home(5)))
    assert answer.verdict == both_checkers(answer.text) == "proved"
    assert answer.leaves == len(answer.searches) == 10
    assert json.loads(answer.text)["schema"] == "qbound/certificate/2"


@pytest.mark.parametrize("half", [5, 20])
def test_boundaries_that_are_nearly_reached_are_proved_and_reached_ones_are_refuted(half):
    """A hundredth of a metre is left of each; a margin of a little more is not kept."""
    text, ends = tight_arm(half), around_home(half)
    answer = certify(text, statements.box(*ends))
    assert answer.verdict == both_checkers(answer.text) == "proved"
    assert answer.leaves < 200
    answer = certify(text, statements.box(*ends, "0.011"))
    assert answer.verdict == both_checkers(answer.text) == "refuted"
    low, high = (np.array(end, float) for end in ends)
    assert ((low <= answer.witness.q) & (answer.witness.q <= high)).all()
    assert answer.witness.depth > 0.0009


def test_cutting_where_it_bends_most_takes_fewer_cells_than_the_longest_edge(monkeypatch):
    text, statement = tight_arm(20), statements.box(*around_home(20))
    few = certify(text, statement).leaves
    longest = lambda self, centres, halves: halves.argmax(axis=1)  # noqa: E731
    monkeypatch.setattr(boxes.BoxBound, "worst_joints", longest)
    assert certify(text, statement).leaves > 5 * few


@pytest.mark.parametrize("seed", range(8))
def test_no_false_answer_on_random_robots_of_many_joints(seed):
    joints = 3 + seed % 4
    text, ends = robot_file(seed, joints), box_of(seed, joints)
    robot = parse_robot(tomllib.loads(text))
    least = min(least_margins(robot, *ends, seed).values())
    for more in (-0.1, 1e-6, 0.3):
        if least + more >= 0:
            statement = statements.box(*ends, statements.decimal(least + more))
            answer = certify(text, statement, most=3000)
            assert answer.verdict != ("proved" if more > 0 else "nothing")
            if answer.text:
                assert both_checkers(answer.text) == answer.verdict
    if least < 0:
        answer = certify(text, statements.box(*ends), most=3000)
        assert answer.verdict == both_checkers(answer.text) == "refuted"


def test_random_robots_of_many_joints_are_proved_and_refuted_both():
    """Or the test above could not fail."""
    verdicts = []
    for seed in range(8):
        joints = 3 + seed % 4
        text, ends = robot_file(seed, joints), box_of(seed, joints)
        verdicts.append(certify(text, statements.box(*ends), most=3000).verdict)
    assert verdicts.count("proved") >= 2
    assert verdicts.count("refuted") >= 2


@pytest.mark.parametrize("seed", range(12))
def test_the_bound_is_below_the_form_and_close_to_it_on_small_boxes(seed):
    joints = 1 + seed % 5
    robot = parse_robot(tomllib.loads(robot_file(seed, joints)))
    rng = np.random.default_rng(seed)
    units = statements.units(robot)
    centre = rng.uniform(-3, 3, joints)
    for size in (1e-4, 0.3, 3.0):
        half = size * rng.random(joints) * units
        for boundary in robot.boundaries:
            form = clearance(robot, boundary)
            bound = boxes.BoxBound(form, half > 0)
            [least], [corner] = bound.least((centre * units)[None], half[None])
            q = centre * units + half * rng.uniform(-1, 1, (500, joints))
            values = np.append(form(q), form(corner))
            assert least <= values.min() + 1e-9
            if size == 1e-4:
                assert least == pytest.approx(form(corner), abs=1e-4)


# --- faults in the search -------------------------------------------------------------------------

SEARCH = boxes.search_box
LEAST, HALVED, CUT, INIT = boxes.BoxBound.least, boxes.halved, Forest.cut, boxes.BoxBound.__init__


def without_bending(self, form, free):
    INIT(self, form, free)
    self.matrix = 0 * self.matrix


def with_half_the_bending(self, form, free):
    INIT(self, form, free)
    self.matrix = self.matrix / 2


def without_slides(self, centres, halves):
    return np.zeros(len(centres))


FAULTS = {
    "no bending": (boxes.BoxBound, "__init__", without_bending),
    "half the bending": (boxes.BoxBound, "__init__", with_half_the_bending),
    "the value at the centre": (
        boxes.BoxBound,
        "least",
        lambda self, c, h: (self.form(c), LEAST(self, c, h)[1]),
    ),
    "the bound a little higher": (
        boxes.BoxBound,
        "least",
        lambda self, c, h: (LEAST(self, c, h)[0] + 0.02, c),
    ),
    "halves exchanged": (
        boxes,
        "halved",
        lambda c, h, j: tuple(
            x.reshape(-1, 2, x.shape[1])[:, ::-1].reshape(x.shape) for x in HALVED(c, h, j)
        ),
    ),
    "the next joint's letter": (Forest, "cut", lambda self, n, e: CUT(self, n, (e + 1) % 6)),
    "a leaf left out": (Forest, "_tree", lambda self, root, tree=Forest._tree: tree(self, root)[:-1]),
    "a leaf too many": (Forest, "_tree", lambda self, root, tree=Forest._tree: tree(self, root) + "."),
    "a part of the box": (prover, "search_box", lambda form, low, high, *rest: SEARCH(form, low + (high - low) / 4, high, *rest)),
    "the margin ignored": (prover, "wider", lambda robot, statement: robot),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_both_checkers_see_a_fault_of_the_search(monkeypatch, name):
    """Margins from what is surely kept to what is not: the fault shows in one at least."""
    text, ends = tight_arm(20), around_home(20)
    robot = parse_robot(tomllib.loads(text))
    place, attribute, fault = FAULTS[name]
    monkeypatch.setattr(place, attribute, fault)
    seen = 0
    for margin in ("0", "0.005", "0.011", "0.03"):
        statement = statements.box(*ends, margin)
        searches = prover.search_all(robot, statement, [statement["points"][0]], 20_000)
        if any(found.left or found.violation is not None for found in searches.values()):
            continue
        proof = {boundary: list(found.trees) for boundary, found in searches.items()}
        file = written(text, statement, proof)
        try:
            check.check(file)
        except ValueError:
            seen += 1
            with pytest.raises(ValueError, match=r"."):
                check_arb.verify(file)
        else:
            assert check_arb.verify(file) == "proved"  # lucky, but right
    assert seen


def written(text, statement, proof):
    return json.dumps(
        {
            "schema": "qbound/certificate/2",
            "verdict": "proved",
            "statement": statement,
            "robot": text,
            "sha256": check.digest(text),
            "proof": proof,
        }
    )
