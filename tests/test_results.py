"""Results: the promised form, errors and digits, the same bytes twice, complete or not at all."""

import hashlib
import json
import math
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from lizarraga2025.results import EXACT, Results, last_place, places, share_of_error
from qbound import __version__
from qbound.model.robotfile import robot_text

SCHEMA = {
    "type": "object",
    "additionalProperties": False,
    "required": ["schema", "version", "robots", "chapter", "results"],
    "properties": {
        "schema": {"const": "qbound/results/2"},
        "version": {"const": __version__},
        "robots": {"type": "object", "additionalProperties": {"pattern": "^[0-9a-f]{64}$"}},
        "chapter": {"type": "string"},
        "results": {
            "type": "array",
            "items": {
                "type": "object",
                "additionalProperties": False,
                "required": ["id", "value", "unit", "reference", "rule", "error"],
                "properties": {
                    "id": {"type": "string"},
                    "value": {"type": ["number", "string", "array", "boolean"]},
                    "unit": {"enum": ["deg", "cm", "cm^2", "deg^2", "rad^2", "1"]},
                    "reference": {"type": "string"},
                    "rule": {"enum": ["paper", "clearance", "none"]},
                    "error": {"type": "number", "minimum": 0},
                },
            },
        },
    },
}
"""The promise of the interface, written a second time."""


def example() -> Results:
    results = Results("region", "minervabot-v2")
    area = np.float64(2 / 3)
    results.add("area", area, "deg^2", error=1e-13, reference="Figure 5", rule="paper")
    results.add("vertex", np.array([[1 / 3, -1e-7], [0.1, 23456.7890123456]]), "deg", error=4e-11)
    results.add("count", 6, "1", error=EXACT)
    results.add("curves", ["β_{1,3,1}", "beta_{4,1,2}"], "1", error=EXACT, rule="clearance")
    return results


def test_file_has_the_promised_form(tmp_path: Path) -> None:
    path = example().save(tmp_path)
    assert path == tmp_path / "region.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(content)
    assert content["chapter"] == "region"
    assert [entry["id"] for entry in content["results"]] == ["area", "vertex", "count", "curves"]
    area, vertex, count, curves = content["results"]
    assert area == {
        "id": "area", "value": 0.6666666666667, "unit": "deg^2", "reference": "Figure 5",
        "rule": "paper", "error": 1.5e-13,
    }  # fmt: skip
    assert vertex["value"] == [[0.33333333333, -1e-7], [0.1, 23456.7890123456]]
    assert (count["value"], count["reference"], count["rule"]) == (6, "", "none")
    assert curves["value"] == ["β_{1,3,1}", "beta_{4,1,2}"]


def test_a_robot_is_named_by_the_hash_of_its_file(tmp_path: Path) -> None:
    text, _ = robot_text("minervabot-v2")
    file = tmp_path / "arm.toml"
    file.write_bytes(text.encode())
    wanted = hashlib.sha256(file.read_bytes()).hexdigest()
    assert Results("region", "minervabot-v2", file).robots == {
        "minervabot-v2": wanted,
        "arm": wanted,
    }


# --- errors and digits ----------------------------------------------------------------------------


def test_an_error_has_to_be_stated() -> None:
    with pytest.raises(TypeError, match="error"):
        Results("x").add("n", 1.5, "1")  # type: ignore[call-arg]


@pytest.mark.parametrize("error", [-1.0, np.nan, np.inf])
def test_a_bound_is_a_number_that_is_not_negative(error: float) -> None:
    with pytest.raises(ValueError, match=r"n: .* is no bound of an error"):
        Results("x").add("n", 1.5, "1", error=error)


def test_what_was_computed_is_no_exact_decimal() -> None:
    results = Results("x")
    with pytest.raises(ValueError, match="state its error"):
        results.add("n", 1 / 3, "1", error=EXACT)
    results.add("n", 0.95, "1", error=EXACT)
    assert results.entries[0]["value"] == 0.95


MAGNITUDES = st.floats(-1e9, 1e9, allow_subnormal=False)
ERRORS = st.floats(-15, 6).map(lambda exponent: 10.0**exponent)


@given(MAGNITUDES, ERRORS)
def test_a_number_has_the_digits_that_its_error_allows(number: float, error: float) -> None:
    """What is written is a multiple of a place within the error, and the error covers both."""
    results = Results("x")
    results.add("n", number, "1", error=error)
    (entry,) = results.entries
    place = Decimal(10) ** -places(max(error, float(np.spacing(abs(number)))))
    assert Decimal(repr(entry["value"])) % place == 0
    assert float(place) <= entry["error"] * (2 + 1e-12)
    rounded = abs(entry["value"] - number) - float(np.spacing(abs(number)))
    assert rounded + error <= entry["error"] * (1 + 1e-9)
    assert entry["error"] <= 2.3 * max(error, float(np.spacing(abs(number))))


def test_the_last_noisy_digit_does_not_reach_the_file(tmp_path: Path) -> None:
    """0.1 + 0.2 and 0.3 are one result."""
    for name, value in (("one", 0.1 + 0.2), ("two", 0.3)):
        results = Results("x")
        results.add("n", value, "1", error=1e-14)
        results.save(tmp_path / name)
    assert (tmp_path / "one/x.json").read_bytes() == (tmp_path / "two/x.json").read_bytes()


def test_numbers_written_out_have_the_error_of_their_last_place() -> None:
    assert last_place("-94.073421", "2.5") == 0.1
    assert last_place("0.650011309404") == 1e-12


# --- files ----------------------------------------------------------------------------------------


def test_same_bytes_on_a_second_run(tmp_path: Path) -> None:
    first = example().save(tmp_path).read_bytes()
    assert example().save(tmp_path).read_bytes() == first
    assert first.endswith(b"\n")
    assert "β".encode() in first
    assert b"\r" not in first


def test_add_returns_the_value_itself() -> None:
    value = np.array([1.0, 2.0])
    assert Results("x").add("v", value, "cm", error=1e-12) is value


@pytest.mark.parametrize(
    ("value", "plain"),
    [
        (np.int64(3), 3), (np.array([1, 2]), [1, 2]), ((1, 2.5), [1, 2.5]), (True, True),
        (np.array(2.5), 2.5), (np.float32(0.5), 0.5), ([[np.int32(7)]], [[7]]), (np.bool_(1), True),
    ],
    ids=str,
)  # fmt: skip
def test_numpy_values_become_plain_ones_of_their_kind(value, plain) -> None:
    """A count stays a whole number in the file."""
    results = Results("x")
    results.add("v", value, "1", error=1e-12)
    assert json.dumps(results.entries[0]["value"]) == json.dumps(plain)


BAD = [np.nan, np.inf, -np.inf, [1.0, np.nan], np.array([[1, 2], [3, np.inf]])]


@pytest.mark.parametrize("value", BAD, ids=str)
def test_a_number_that_is_not_finite_is_refused(value) -> None:
    results = Results("x")
    with pytest.raises(ValueError, match="is no result"):
        results.add("v", value, "1", error=1e-12)
    assert results.entries == []


def test_an_id_is_unique_within_its_chapter() -> None:
    results = example()
    with pytest.raises(ValueError, match="'area' is there already"):
        results.add("area", 1.0, "deg^2", error=EXACT)
    assert len(results.entries) == 4


def test_a_write_that_fails_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Complete or not at all."""
    path = example().save(tmp_path)
    before = path.read_bytes()

    def half(self: Path, content: bytes) -> int:
        with self.open("wb") as file:
            file.write(content[: len(content) // 2])
        raise OSError("disk full")

    changed = example()
    changed.add("more", 1.0, "1", error=EXACT)
    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", half)
        with pytest.raises(OSError, match="disk full"):
            changed.save(tmp_path)
    assert path.read_bytes() == before
    changed.save(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["region.json"]


def test_the_folder_is_the_argument_then_the_environments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("QBOUND_RESULTS", str(tmp_path / "elsewhere"))
    assert example().save() == tmp_path / "elsewhere" / "region.json"
    assert example().save(tmp_path / "here") == tmp_path / "here" / "region.json"


def test_outside_of_a_build_nothing_is_written_and_a_line_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In a project, too: what a reader tries in a chapter changes no file that git tracks."""
    (tmp_path / "pyproject.toml").touch()
    (tmp_path / "results").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("QBOUND_RESULTS", raising=False)
    assert example().save() is None
    [line] = capsys.readouterr().out.splitlines()
    assert line == "region.json is not written: results are recorded when the book is made."
    assert list((tmp_path / "results").iterdir()) == []


# --- a result and its earlier self ----------------------------------------------------------------

ENTRY = {"id": "a", "unit": "cm", "value": [1.5, 2.0, "up", 3], "error": 0.015}


@pytest.mark.parametrize(
    ("change", "share"),
    [
        ({}, 0.0),
        ({"value": [1.5, 2.003, "up", 3]}, 0.2),
        ({"value": [1.53, 2.0, "up", 3]}, 2.0),
        ({"value": [1.5, 2.0, "up", 4]}, math.inf),
        ({"value": [1.5, 2.0, "down", 3]}, math.inf),
        ({"value": [1.5, 2.0, "up"]}, math.inf),
        ({"unit": "mm"}, math.inf),
        ({"error": 0.016}, 0.0),
        ({"error": 0.03}, math.inf),
    ],
)
def test_a_result_is_compared_by_its_stated_error(change: dict, share: float) -> None:
    assert share_of_error(ENTRY | change, ENTRY) == pytest.approx(share)


def test_an_exact_result_has_to_be_the_same() -> None:
    exact = {"id": "a", "unit": "cm", "value": 2.5, "error": 0.0}
    assert share_of_error(exact, exact) == 0
    assert share_of_error(exact | {"value": 2.5000001}, exact) == math.inf
