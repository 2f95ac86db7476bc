"""What the printed digits leave open: the draws, the derivatives and the record of both."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from engine_support.commands import follows_schema
from lizarraga2025 import recorded
from lizarraga2025.commands import main
from lizarraga2025.printed import HALF_DIGIT
from lizarraga2025.recorded import DRAWS
from lizarraga2025.uncertainty import (
    BY_CHOICE,
    SEED,
    STEP,
    Value,
    chapters_2_to_9,
    corrected,
    study,
)
from qbound import load_robot, window_region
from qbound.symbols import offset_values

ROBOT = load_robot("minervabot-v2")
OPEN = recorded.input_uncertainties()
RESULTS = {entry["id"]: entry for entry in recorded.results()}
PRINTED = {str(symbol): value for symbol, value in offset_values(ROBOT).items()}


# --- by other formulas ----------------------------------------------------------------------------

PAIRS = {"B1": ("0,6", "1,7"), "B2": ("0,8", "1,9"), "B3": ("1,10", "2,11"), "B4": ("1,12", "2,13")}


def by_hand(o: dict[str, Any], steps: int = 20_001) -> dict[str, Any]:
    """Return some results for arrays of offsets, with nothing but NumPy.

    Components 1 and 3 of a pair are ``x_b cos q + z_b sin q - x_a`` and
    ``z_b cos q - x_b sin q - z_a``, both points seen from the joint between them.
    """
    ends: dict[str, Any] = {}
    for name, (a, b) in PAIRS.items():
        x_a, z_a, x_b, z_b = (o[f"{axis}_{{{label}}}"] for label in (a, b) for axis in "xz")
        x_j, z_j = (0, o["z_{0,1}"]) if a[0] == "0" else (o["x_{1,2}"], o["z_{1,2}"])
        x_a, z_a, r = x_a - x_j, z_a - z_j, np.hypot(x_b, z_b)
        ends[f"{name},1"] = np.arctan2(z_b, x_b) + np.arccos(x_a / r)
        ends[f"{name},3"] = np.arctan2(-x_b, z_b) + np.arccos(z_a / r)
    gap = np.abs(r - np.hypot(x_a, z_a))  # of the last pair
    sides = [np.stack([ends[f"{n},{j}"] for n in names for j in (1, 3)]) for names in ONE_JOINT]
    low, high = ([pick(side) for side in sides] for pick in (a_turn_below_the_highest, lowest))
    q1 = np.linspace(low[0], high[0], steps)
    h = o["z_{0,1}"] - o["z_{min,1}"] - o["x_{1,2}"] * np.sin(q1) + o["z_{1,2}"] * np.cos(q1)
    width = np.arccos(np.clip(-h / o["x_{2,3}"], -1, 1))
    middle = -np.pi / 2 - q1  # there link 2 points up
    length = np.minimum(high[1], middle + width) - np.maximum(low[1], middle - width)
    return {
        "paper.area": np.trapezoid(length, q1, axis=0),
        "mended.q2.lower": np.degrees(low[1]),
        "beta_{3,3,1}": np.degrees(ends["B3,3"]),
        "B4.closest.gap": gap,
        "link1.length": np.hypot(o["x_{1,2}"], o["z_{1,2}"]),
        "by beta_{3,3}": ends["B3,3"] == high[1],
    }


ONE_JOINT = (("B1", "B2"), ("B3", "B4"))


def lowest(side: np.ndarray) -> np.ndarray:
    return side.min(axis=0)


def a_turn_below_the_highest(side: np.ndarray) -> np.ndarray:
    return side.max(axis=0) - 2 * np.pi


@pytest.fixture(scope="module")
def drawn() -> dict[str, Any]:
    """The offsets of the same arms."""
    shifts = np.random.default_rng(SEED).uniform(-1, 1, (DRAWS, len(PRINTED))) * HALF_DIGIT
    numbers = np.array(list(PRINTED.values())) + shifts
    return dict(zip(PRINTED, numbers.T, strict=True))


def extremes(name: str) -> list[float]:
    return [OPEN[name]["draws_from"], OPEN[name]["draws_to"]]


DIRECT = ("paper.area", "beta_{3,3,1}", "B4.closest.gap", "link1.length")


@pytest.mark.parametrize("name", DIRECT)
def test_the_draws_are_those_of_other_formulas(name: str, drawn: dict[str, Any]) -> None:
    found = by_hand(drawn)[name]
    assert extremes(name) == pytest.approx([found.min(), found.max()], abs=1e-6)
    change = np.abs(found - RESULTS[name]["value"]).max()
    assert change * (1 - 1e-4) <= OPEN[name]["input_uncertainty"] <= 1.11 * change


def test_the_side_without_the_misprint_is_that_of_other_formulas(drawn: dict[str, Any]) -> None:
    there = by_hand(drawn | {"x_{2,13}": drawn["x_{2,13}"] + 0.09})["mended.q2.lower"]
    assert extremes("mended.q2.lower") == pytest.approx([there.min(), there.max()], abs=1e-6)


@pytest.mark.parametrize("name", DIRECT)
def test_the_first_order_is_that_of_finite_differences(name: str) -> None:
    """With a step a hundred times as long, in other formulas."""
    effects = []
    for label in PRINTED:
        offsets = {key: np.full(2, x) for key, x in PRINTED.items()}
        offsets[label] = offsets[label] + 100 * STEP * np.array([1, -1])
        up, down = by_hand(offsets, 200_001)[name]
        effects.append(abs(up - down) / (200 * STEP) * HALF_DIGIT)
    assert OPEN[name]["first_order"] == pytest.approx(sum(effects), rel=1e-3)


def test_the_digits_do_not_decide_which_bound_is_the_upper_side_of_q2(
    drawn: dict[str, Any],
) -> None:
    share = by_hand(drawn)["by beta_{3,3}"].mean()
    first, second = "beta_{3,3,1}, beta_{7,3,1}", "beta_{3,1,1}, beta_{7,3,1}"
    assert OPEN["vertex.4.bounds"]["shares"] == pytest.approx({first: share, second: 1 - share})
    assert 0.2 < share < 0.8
    assert OPEN["paper.area"]["another_boundary"] >= 1 - share
    assert RESULTS["vertex.4.bounds"]["input_uncertainty"] is None


# --- the study ------------------------------------------------------------------------------------


def of_point_13(robot: Any) -> dict[str, Value]:
    x, _, z = map(float, robot.point("13").at)
    side = "above" if x > 9.0 else "below"
    found = {"x": Value(x), "kink": Value(abs(x - 9.0), (side,)), "side": Value(side)}
    return found | {"n": Value(7), "sum": Value(x + z)}


def test_a_kink_is_told_where_a_first_order_misses_it() -> None:
    x, kink, side, count, both = study(ROBOT, of_point_13)
    assert HALF_DIGIT * 0.9 < x["input_uncertainty"] <= HALF_DIGIT
    assert x["first_order"] == pytest.approx(HALF_DIGIT)
    assert both["first_order"] == pytest.approx(2 * HALF_DIGIT)
    assert x["without_misprint"] == pytest.approx(9.09)
    assert "another_boundary" not in x
    assert kink["first_order"] == pytest.approx(0, abs=1e-6)
    assert kink["draws_to"] > 0.9 * HALF_DIGIT
    assert kink["another_boundary"] == side["shares"]["above"] == pytest.approx(0.5, abs=0.15)
    assert "input_uncertainty" not in side
    assert (count["input_uncertainty"], count["shares"]) == (0.0, {"7": 1.0})


def test_a_corrected_arm_is_corrected_once() -> None:
    once = corrected(ROBOT)
    assert once.point("13").at[0] == pytest.approx(9.09)
    assert corrected(once).point("13").at[0] == once.point("13").at[0]
    assert ROBOT.point("13").at[0] == 9.0


# --- the record -----------------------------------------------------------------------------------


def numbers(value: Any) -> Iterator[float]:
    if isinstance(value, list | tuple | np.ndarray) and np.ndim(value):
        for one in value:
            yield from numbers(one)
    else:
        yield float(value)


def test_what_is_drawn_is_what_the_chapters_record() -> None:
    """At the printed offsets, within the error of the record and a part of what is left open."""
    for name, (value, _) in chapters_2_to_9(ROBOT).items():
        entry = RESULTS[name]
        if isinstance(value, str):
            assert value == ", ".join(entry["value"])
            continue
        error = 1.001 * entry["numerical_error"] + 1e-3 * entry["input_uncertainty"] + 1e-14
        apart = np.subtract([*numbers(value)], [*numbers(entry["value"])])
        assert np.abs(apart).max() <= error, name


def test_every_result_of_the_paper_was_studied_but_for_grids_and_the_other_arctangent() -> None:
    of_paper = {e["id"] for e in RESULTS.values() if e["chapter"] in recorded.PAPER[1:9]}
    of_grids = {"contour.errors", "contour.judged.errors", "contour.slope"}
    assert of_paper - set(OPEN) == of_grids | {"arctan.area"}
    assert set(BY_CHOICE) <= set(OPEN) <= set(RESULTS)


def test_the_record_keeps_to_its_schema_and_names_its_draws() -> None:
    text = (recorded.folder() / recorded.UNCERTAINTIES).read_text(encoding="utf-8")
    content = json.loads(text)
    follows_schema(content, "input_uncertainty", "lizarraga2025")
    told = content["draws"], content["seed"], content["half_digit"]
    assert told == (DRAWS, SEED, HALF_DIGIT)


def test_every_record_has_what_the_draws_left_open() -> None:
    for entry in recorded.results():
        assert entry["input_uncertainty"] == OPEN.get(entry["id"], {}).get("input_uncertainty")


def test_a_number_is_written_with_the_digits_that_the_printed_ones_allow() -> None:
    area, other = window_region(ROBOT).area, window_region(corrected(ROBOT)).area
    written = f"{area:.2f} ± 0.02 rad²; with the other digit {other:.2f}"
    assert recorded.with_uncertainty(RESULTS["paper.area"], " rad²") == written
    reached = RESULTS["workspace.area.clearance"]
    assert recorded.with_uncertainty(reached) == f"{reached['value']:.0f} ± 4"
    with pytest.raises(ValueError, match="no printed digit is known to leave it open"):
        recorded.with_uncertainty(RESULTS["d_min"])


def test_citation_and_command_state_both_errors(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["--bibtex"], []):
        assert main(["results", "polygon.area", *words]) == 0
        said = capsys.readouterr().out
        entry = RESULTS["polygon.area"]
        assert f"{entry['numerical_error']:g}" in said
        assert f"{entry['input_uncertainty']:g}" in said
        assert f"9.09 for 9.00 it is {OPEN['polygon.area']['without_misprint']:.6g}" in said
