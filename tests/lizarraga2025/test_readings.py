"""What Figure 11 may draw red, each against the formulas that are expanded by hand."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from engine_support.oracles import equation_29, packaged_table, row_of, table_6
from lizarraga2025.readings import (
    in_windows,
    keeps_components_positive,
    keeps_geometric,
    keeps_third_components_positive,
    misses_points,
)
from qbound import load_robot
from qbound.robotfile import read_robot

Q = np.random.default_rng(11).uniform(-np.pi, np.pi, (40_000, 2))
USED = {name: beta for name, beta in equation_29(*Q.T).items() if name[6] in "12347"}
HEIGHT, ENDS = USED["beta_{7,3}"], table_6(np.arctan2)
IN_BOX = [
    ENDS["beta_{2,1,2}"] <= Q[:, 0],
    Q[:, 0] <= ENDS["beta_{1,3,1}"],
    ENDS["beta_{4,1,2}"] <= Q[:, 1],
    Q[:, 1] <= ENDS["beta_{3,3,1}"],
]
BY_HAND = {
    misses_points: np.ones(len(Q), dtype=bool),  # a coincidence has probability 0
    keeps_geometric: HEIGHT >= 0,
    in_windows: np.all([*IN_BOX, HEIGHT >= 0], axis=0),
    keeps_components_positive: np.all([beta >= 0 for beta in USED.values()], axis=0),
    keeps_third_components_positive: np.all(
        [beta >= 0 for name, beta in USED.items() if name.endswith("3}")], axis=0
    ),
}


@pytest.mark.parametrize("reading", BY_HAND, ids=lambda reading: reading.__name__)
def test_a_reading_is_what_its_equation_says(reading) -> None:
    allowed = reading(load_robot("minervabot-v2"), Q)
    assert_array_equal(allowed, BY_HAND[reading])
    assert 0 < allowed.mean() < 1 or reading is misses_points


def test_points_that_coincide_are_a_collision() -> None:
    """Eq. (17) to the letter: only B = 0 exactly."""
    table = packaged_table()
    row_of(table, "point", "7")["at"] = [7.5, 0, -10.0]  # on point 6 at home
    q = np.array([[0.0, 1.0], [1e-9, 1.0]])
    assert_array_equal(misses_points(read_robot(table), q), [False, True])


@pytest.mark.parametrize(
    "reading", [r for r in BY_HAND if r is not in_windows], ids=lambda r: r.__name__
)
def test_a_robot_without_boundaries_has_no_collision(reading) -> None:
    assert reading(read_robot(packaged_table() | {"boundary": []}), Q[:7]).tolist() == [True] * 7
