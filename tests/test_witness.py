"""The engine as a witness of the small library, and a plain judge of both.

The arms are the paper's three and a hundred more, whose offsets are moved by up to 0.5 cm; SEED was
fixed before the first run. Every arm is the table of a robot file, which all three read.
"""

from __future__ import annotations

import copy
import tomllib
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace.region import solve, window_problem
from qbound import Workspace, window_region
from qbound.robotfile import ROBOTS, read_robot
from support.plain_judge import Judge

SEED = 37
SPREAD = 0.5
NAMES = ["minervabot-v2", "minervabot-v2-corrected", "minervabot-v2-symmetric"]
ARMS = range(103)
REFUSED = 35
"""At most so many arms have a boundary function that folds inside the box: corners are refused."""

AGREEMENT = 1e-12
"""Largest difference of two areas, as part of the area: the stated error of the engine's areas."""


@cache
def tables():
    """Return the tables of all arms."""
    printed = [tomllib.loads((ROBOTS / f"{name}.toml").read_text()) for name in NAMES]
    random = np.random.default_rng(SEED)

    def moved(x):
        return x + random.uniform(-SPREAD, SPREAD) if x else x

    arms = []
    for _ in range(100):
        table = copy.deepcopy(printed[0])
        for key, name in (("joint", "origin"), ("point", "at")):
            for row in table[key]:
                row[name] = [moved(x) for x in row[name]]
        for row in table["boundary"]:
            if "offset" in row:
                row["offset"] = moved(row["offset"])
        arms.append(table)
    return printed + arms


@cache
def small_region(number):
    return window_region(read_robot(tables()[number]))


@cache
def engine_region(number):
    from cspace.model.robotfile import parse_robot

    return solve(window_problem(window_region(parse_robot(tables()[number]))))


@pytest.mark.parametrize("number", ARMS)
def test_library_and_engine_find_one_region(number):
    from cspace.workspace.areas import find_workspace
    from cspace.workspace.planar import planar_arm

    small, engine = small_region(number), engine_region(number)
    reached = Workspace(small)
    exact = find_workspace(planar_arm(engine.robot), engine.problem, engine.robot.home)
    assert len(engine.components) == 1
    for value, error, other in (
        (small.area, small.area_error, engine.area),
        (reached.area, reached.area_error, exact.area),
        (reached.covered_twice, reached.covered_twice_error, exact.covered_twice),
    ):
        assert abs(value - other) <= AGREEMENT * other
        assert abs(value - other) <= error + AGREEMENT * other


@pytest.mark.parametrize("number", ARMS)
def test_corners_are_those_of_the_engine_or_refused(number):
    try:
        corners = small_region(number).polygon
    except ValueError:
        with pytest.raises(ValueError, match="cspace"):
            _ = small_region(number).corners
        return
    vertices = [vertex.q for vertex in engine_region(number).home_component.vertices]
    assert_allclose(np.sort(corners, axis=0), np.sort(vertices, axis=0), atol=1e-12)


def test_few_arms_refuse_corners():
    refused = 0
    for number in ARMS:
        try:
            assert len(small_region(number).corners) == 6
        except ValueError:
            refused += 1
    assert refused <= REFUSED


@pytest.mark.parametrize("number", ARMS)
def test_the_judge_agrees_with_both(number):
    small, engine, judge = small_region(number), engine_region(number), Judge(tables()[number])
    assert_allclose(small.box.lower, judge.low, atol=1e-12)
    assert_allclose(small.box.upper, judge.high, atol=1e-12)
    q = np.random.default_rng(number).uniform(-1.5 * np.pi, np.pi, (2000, 2))
    allowed = judge.inside(*q.T)
    assert np.array_equal(small.contains(q), allowed)
    turned = q[np.abs(q).max(axis=-1) < np.pi]  # within a turn: the engine has its own copies
    assert not (judge.inside(*turned.T) & ~engine.contains(turned)).any()
    counted = judge.area(300)  # by grid: the error is that of the cells on the boundary
    assert_allclose([small.area, engine.area], counted, atol=0.01)


@pytest.mark.parametrize("number", range(0, 103, 10))
def test_the_judge_counts_the_workspace(number):
    reached, judge = Workspace(small_region(number)), Judge(tables()[number])
    assert_allclose([reached.area, reached.covered_twice], judge.workspace(500), atol=12)
