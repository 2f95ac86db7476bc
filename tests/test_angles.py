"""Full turns: which of the angles that name one direction is meant, against counting them out."""

from math import pi, tau

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from qbound.forms.factors import (
    first_from,
    nearest_turn,
    turns_up_to,
    turns_within,
    whole_turns,
)

ANGLES = st.floats(-100, 100)
MANY = np.arange(-60, 61)
"""More turns than any angle here needs."""


@given(ANGLES)
def test_whole_turns_leave_half_a_turn_at_most(angle) -> None:
    turns = float(whole_turns(angle))
    assert turns == round(turns)
    assert abs(angle - tau * turns) <= pi + 1e-12


@given(ANGLES, ANGLES)
def test_the_first_turn_from_a_bound_is_the_least_that_reaches_it(low, q) -> None:
    reached = MANY[q + tau * MANY >= low]
    assert turns_up_to(low, q) == reached[0]
    assert first_from(low, q) == q + tau * reached[0]


def test_an_angle_at_the_bound_is_its_own_first() -> None:
    assert_array_equal(first_from(1.5, [1.5, 1.5 + tau, 1.25]), [1.5, 1.5, 1.25 + tau])


@given(ANGLES, ANGLES)
def test_nearest_turn_moves_by_whole_turns(q, centre) -> None:
    moved = nearest_turn(q, centre)
    turns = (moved - q) / tau
    assert abs(turns - round(float(turns))) < 1e-13
    assert -pi - 1e-12 < moved - centre <= pi + 1e-12


def test_nearest_turn_keeps_the_upper_end() -> None:
    assert_array_equal(nearest_turn([-pi, pi, 0.0], 0.0), [pi, pi, 0.0])


@given(st.lists(ANGLES, min_size=1, max_size=4), ANGLES, st.floats(0, 30))
def test_turns_within_a_range_are_all_and_no_others(q, low, width) -> None:
    """Of one angle exactly those that bring it in; of several none that leaves all on one side."""
    high = low + width
    for one in q:
        inside = MANY[(low <= one + tau * MANY) & (one + tau * MANY <= high)]
        assert_allclose(list(turns_within(low, high, one)), inside)
    together = set(turns_within(low, high, q))
    assert together.issuperset(k for one in q for k in turns_within(low, high, one))
    least, most = min(q), max(q)
    assert all(most + tau * k >= low - 1e-9 and least + tau * k <= high + 1e-9 for k in together)


def test_angles_that_are_not_there_count_for_nothing() -> None:
    assert turns_within(0, 7, [np.nan, 0.5]) == turns_within(0, 7, 0.5) == range(2)
