"""Forms that are left out of a region bound nothing: what is proved irrelevant, beside grids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace.region import Problem, solve
from cspace.region.problem import box_bounds, relevant_forms, without_irrelevant
from engine_support.regions import SIDES, plate
from qbound.forms import HarmonicForm

TURNS, SLIDES = ("revolute", "revolute"), ("prismatic", "prismatic")
KINDS = [TURNS, ("revolute", "prismatic"), ("prismatic", "revolute"), SLIDES]


def places(ranges, n: int = 201) -> np.ndarray:
    lines = [np.linspace(*(ends or (-np.pi, np.pi)), n) for ends in ranges]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)


def random_forms(rng, kinds, count: int) -> HarmonicForm:
    """Forms of all sorts: most are positive nearly everywhere, some nowhere vanish."""
    table = rng.normal(size=(count, 3, 3)) * rng.choice([0.1, 1.0], size=(count, 3, 3))
    table[:, 0, 0] = rng.uniform(-1, 8, count)
    return HarmonicForm(table, kinds)


def ranges_of(rng, kinds):
    ends = [tuple(np.sort(rng.uniform(-2.5, 2.5, 2)) + np.array([-0.2, 0.2])) for _ in kinds]
    return [
        None if kind == "revolute" and rng.random() < 0.5 else pair
        for kind, pair in zip(kinds, ends, strict=True)
    ]


def dip(rng, depth: float) -> np.ndarray:
    """A form of two turns that is positive but round one place, where it is -depth."""
    a, b = rng.uniform(-np.pi, np.pi, 2)
    table = np.zeros((3, 3))
    table[0, 0] = 2 - depth
    table[1:, 0] = -np.cos(a), -np.sin(a)
    table[0, 1:] = -np.cos(b), -np.sin(b)
    return table


@pytest.mark.parametrize("kinds", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_what_is_kept_forbids_what_all_forbid(kinds, seed):
    rng = np.random.default_rng(seed)
    forms, ranges = random_forms(rng, kinds, 60), ranges_of(rng, kinds)
    kept = relevant_forms(forms, ranges)
    values = forms(places(ranges))
    assert ((values[:, kept] > 0).all(axis=1) == (values > 0).all(axis=1)).all()
    assert len(kept) < 60


@pytest.mark.parametrize("depth", [0.0, 1e-15, 1e-12, 1e-8, 1e-4, 1e-2])
def test_a_form_that_vanishes_is_kept_however_little_it_dips(depth):
    rng = np.random.default_rng(5)
    table = np.array([dip(rng, depth) for _ in range(20)])
    kept = relevant_forms(HarmonicForm(table, TURNS), [None, None])
    assert kept.tolist() == list(range(20))


def test_slopes_count_by_how_far_a_joint_slides():
    table = np.zeros((2, 3, 3))
    table[:, 0, 0], table[:, 1, 0] = [5e16, 7e16], [1.0, 0.1]
    kept = relevant_forms(HarmonicForm(table, SLIDES), [(-1e17, 1e17), (0, 1)])
    assert kept.tolist() == [0]


def test_a_form_that_keeps_clear_of_zero_is_left_out():
    rng = np.random.default_rng(6)
    table = np.array([dip(rng, -1e-3) for _ in range(20)])
    assert not len(relevant_forms(HarmonicForm(table, TURNS), [None, None]))


def test_a_dip_outside_the_range_does_not_count_and_one_at_its_end_does():
    table = np.zeros((1, 3, 3))
    table[0, 0, 0], table[0, 1, 0] = 0.5, -1.0  # negative for |q1| < 60 degrees
    form, edge = HarmonicForm(table, TURNS), np.pi / 3
    assert not len(relevant_forms(form, [(edge + 1e-3, 3.0), None]))
    assert len(relevant_forms(form, [(edge, 3.0), None]))
    assert len(relevant_forms(form, [(edge + 1e-3, edge + 1e-3 + 5.5), None]))


@pytest.mark.parametrize("kinds", KINDS)
def test_values_lie_within_the_bounds_of_their_boxes(kinds):
    rng = np.random.default_rng(7)
    forms = random_forms(rng, kinds, 20)
    middles, half = rng.uniform(-2, 2, (30, 2)), np.array([0.4, 0.3])
    low, _, high = box_bounds(forms, middles, half)
    steps = np.append(rng.uniform(-1, 1, (200, 2)), [[1, 1], [1, -1], [-1, 1], [-1, -1]], axis=0)
    values = forms(middles[:, None] + steps * half)
    assert (low[:, None] <= values + 1e-12).all()
    assert (values <= high[:, None] + 1e-12).all()


# --- regions -----------------------------------------------------------------------------------


def both_ways(problem: Problem, monkeypatch):
    monkeypatch.setattr("cspace.region.problem.MANY", 10**9)
    whole = solve(problem)
    monkeypatch.setattr("cspace.region.problem.MANY", 0)
    return whole, solve(replace(problem))


def assert_same(whole, found):
    assert len(found.components) == len(whole.components)
    for one, other in zip(found.components, whole.components, strict=True):
        assert_allclose(one.area, other.area, rtol=1e-9, atol=1e-9)
        assert one.wraps == other.wraps
        assert {v.boundaries for v in one.vertices} == {v.boundaries for v in other.vertices}
    assert found.boundaries == whole.boundaries
    q = places(found.problem.ranges, 17)
    assert (found.margins(q) == whole.margins(q)).all()


@pytest.mark.parametrize("seed", range(3))
def test_the_region_is_the_same_without_what_is_irrelevant(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    table = np.array([dip(rng, rng.uniform(-0.1, 0.1)) for _ in range(24)])
    forms = HarmonicForm(table, TURNS)
    ranges = ((-2.0, 7.0), None)  # more than a turn, and all the way round
    names = tuple(f"B{k}" for k in range(24))
    whole, found = both_ways(Problem(forms, names, ranges, SIDES), monkeypatch)
    assert_same(whole, found)
    assert found.irrelevant
    assert not set(found.irrelevant) & {a.boundary for c in found.components for a in c.loops[0]}


def test_a_hole_inside_a_hole_is_left_out_and_one_that_fills_a_gap_is_not(monkeypatch):
    ring = [(1 + 0.6 * np.cos(t), 1 + 0.6 * np.sin(t), 0.4) for t in np.arange(8) * np.pi / 4]
    problem = plate(*ring, (1.0, 1.0, 0.55), (1.6, 1.0, 0.2))
    whole, found = both_ways(problem, monkeypatch)
    assert_same(whole, found)
    assert len(found.components) == 1  # the gap in the ring stays filled
    assert found.irrelevant == ("hole 9",)


def test_an_empty_region_names_one_form_that_is_negative_throughout(monkeypatch):
    problem = plate((0.0, 0.0, 1.0), (3.0, 2.0, 0.5), (1.0, 1.0, 50.0), (2.0, 2.0, 40.0))
    monkeypatch.setattr("cspace.region.problem.MANY", 0)
    region = solve(problem)
    assert region.components == ()
    assert len(region.empty_because) == 1
    assert region.empty_because[0] in {"hole 2", "hole 3"}
    assert len(region.irrelevant) == 3


def test_nothing_is_left_out_of_few_forms():
    problem = plate((0.0, 0.0, 1.0), (50.0, 50.0, 1.0))
    assert without_irrelevant(problem) == (problem, ())
    assert solve(problem).irrelevant == ()
