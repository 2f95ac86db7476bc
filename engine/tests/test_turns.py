"""Full turns: how many an angle has, and how many bring it into a range."""

from math import pi, tau

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cspace.forms.factors import turns_within, whole_turns

ANGLES = st.floats(-100, 100)
MANY = np.arange(-60, 61)
"""More turns than any angle here needs."""


@given(ANGLES)
def test_whole_turns_leave_half_a_turn_at_most(angle) -> None:
    turns = float(whole_turns(angle))
    assert turns == round(turns)
    assert abs(angle - tau * turns) <= pi + 1e-12


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
