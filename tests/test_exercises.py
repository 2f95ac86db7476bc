"""The cells of exercises: right, wrong and not filled in, without giving the answer away."""

import doctest
from typing import Any

import numpy as np
import pytest

from lizarraga2025 import exercises
from lizarraga2025.exercises import UNFILLED, check


def test_its_examples_run() -> None:
    assert doctest.testmod(exercises).failed == 0


@pytest.mark.parametrize("expected", [6, 0.964, "home", True, {1, 2}, [1.0, 2.0], np.zeros((2, 2))])
def test_three_dots_are_no_answer(expected: Any) -> None:
    assert check(..., expected) == UNFILLED


@pytest.mark.parametrize(
    ("answer", "expected", "within"),
    [
        (6, 6, 0),
        (0.96, 0.964038, 0.005),
        (-94.0734, np.float64(-94.073423), 1e-4),
        ([1, 2], np.array([1.001, 1.999]), 0.01),
        (np.array([1.0]), [1], 0),
        ("home", "home", 0),
        (True, True, 0),
        ({"B7", "B3"}, {"B3", "B7"}, 0),
        (frozenset({1}), {1}, 0),
        (5.0, 4.0, 1.0),
    ],
)
def test_a_right_answer_is_right(answer: Any, expected: Any, within: float) -> None:
    assert check(answer, expected, within=within) == "Right."


@pytest.mark.parametrize(
    ("answer", "expected", "within", "hint"),
    [
        (7, 6, 0, "too large"),
        (5, 6, 0.5, "too small"),
        (-95, -94.07, 0.5, "too small"),
        ([1, 2], [1, 3], 0, "Not yet."),
        ([1, 2, 3], [1, 3], 0, "2 numbers are asked for"),
        (1.0, [1, 3], 0, "2 numbers are asked for"),
        ("six", 6, 0, "a number is asked for"),
        (None, 6, 0, "a number is asked for"),
        ({1}, 6, 0, "a number is asked for"),
        ([[1], [1, 2]], [1, 2], 0, "a number is asked for"),
        (1 + 2j, 1.0, 5, "a number is asked for"),
        ("away", "home", 0, "Not yet."),
        (False, True, 0, "Not yet."),
        ([1, 2], {1, 2}, 0, "Not yet."),
        (float("nan"), 6, 1, "a number is asked for"),
        (float("inf"), 6, 1, "too large"),
    ],
)
def test_a_wrong_answer_is_not_yet_right(
    answer: Any, expected: Any, within: float, hint: str
) -> None:
    said = check(answer, expected, within=within)
    assert said.startswith("Not yet")
    assert hint in said
    assert "Right" not in said


@pytest.mark.parametrize("expected", [41.7, [41.7, 12.3]])
def test_no_answer_gives_the_result_away(expected: Any) -> None:
    assert "41" not in check(40, expected) + check(50, expected) + check("?", expected)


@pytest.mark.parametrize("within", [-1.0, float("nan"), float("inf")])
def test_a_tolerance_that_cannot_be_is_refused(within: float) -> None:
    with pytest.raises(ValueError, match="is no tolerance"):
        check(6, 6, within=within)
