"""Polylines of curves: the deviation that is stated holds between the places looked at, too."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qbound.geometry.polygon import deviations, flatten


def circle(radius):
    def at(s):
        return radius * np.stack([np.cos(6 * s), np.sin(6 * s)], axis=-1)

    return at


@given(st.floats(0.01, 100), st.floats(1e-6, 1e-2))
def test_the_curve_is_within_the_tolerance_of_its_polyline(radius, part) -> None:
    """A circle's chord is farthest from it in the middle, by r (1 - cos(half angle))."""
    s, stated = flatten(circle(radius), part * radius)
    exact = radius * (1 - np.cos(6 * np.diff(s).max() / 2))
    assert exact <= stated * (1 + 1e-6) <= part * radius
    assert (s[0], s[-1]) == (0, 1)
    assert (np.diff(s) > 0).all()


def test_a_finer_tolerance_costs_points_by_its_square_root() -> None:
    few, many = (len(flatten(circle(1), d)[0]) for d in (1e-3, 1e-7))
    assert 50 < many / few < 200


def test_a_straight_line_needs_no_more_points_than_it_gets() -> None:
    s, off = flatten(lambda s: np.stack([s, 2 * s], axis=-1), 1e-9, parts=1)
    assert len(s) == 5
    assert off < 1e-15


def test_a_corner_between_the_looks_is_closed_in() -> None:
    """A curve with a corner at 1/3 is refined there until nothing sticks out."""
    s, _ = flatten(lambda s: np.stack([s, np.abs(s - 1 / 3)], axis=-1), 1e-6)
    assert np.abs(s - 1 / 3).min() < 1e-5


def test_deviation_is_that_from_the_piece_and_not_from_its_line() -> None:
    """A curve that runs back over itself: 1 beyond the chord's end."""
    off = deviations(
        lambda s: np.stack([np.where(s < 0.5, 4 * s, 4 - 4 * s), 0 * s], axis=-1),
        np.array([0.0, 1.0]),
    )
    assert off == pytest.approx([2.0])


@pytest.mark.parametrize("bad", [0, -1, np.nan])
def test_a_deviation_is_above_zero(bad) -> None:
    with pytest.raises(ValueError, match="above 0"):
        flatten(circle(1), bad)


def test_what_winds_ever_faster_cannot_be_followed() -> None:
    """Endlessly many turns of a circle on the way to one place."""

    def winding(s):
        angle = 20 * np.log(np.abs(s - 0.3141))
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    with pytest.raises(ValueError, match="not smooth"):
        flatten(winding, 1e-2)
