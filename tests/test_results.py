"""Results: the promised form, digits, the same bytes twice, complete or not at all."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from lizarraga2025.results import DIGITS, Results

SCHEMA = {
    "type": "object",
    "additionalProperties": False,
    "required": ["schema", "chapter", "results"],
    "properties": {
        "schema": {"const": "qbound/results/1"},
        "chapter": {"type": "string"},
        "results": {
            "type": "array",
            "items": {
                "type": "object",
                "additionalProperties": False,
                "required": ["id", "value", "unit", "reference", "rule"],
                "properties": {
                    "id": {"type": "string"},
                    "value": {"type": ["number", "string", "array", "boolean"]},
                    "unit": {"enum": ["deg", "cm", "cm^2", "deg^2", "rad^2", "1"]},
                    "reference": {"type": "string"},
                    "rule": {"enum": ["paper", "clearance", "none"]},
                },
            },
        },
    },
}
"""The promise of the interface, written a second time."""


def example() -> Results:
    results = Results("region")
    results.add("area", np.float64(2 / 3), "deg^2", reference="Figure 5", rule="paper")
    results.add("vertex", np.array([[1 / 3, -1e-7], [0.1, 123456.789012345678]]), "deg")
    results.add("count", 6, "1")
    results.add("curves", ["β_{1,3,1}", "beta_{4,1,2}"], "1", rule="clearance")
    return results


def test_file_has_the_promised_form(tmp_path: Path) -> None:
    path = example().save(tmp_path)
    assert path == tmp_path / "region.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(content)
    assert content["chapter"] == "region"
    assert [entry["id"] for entry in content["results"]] == ["area", "vertex", "count", "curves"]
    area, _, count, curves = content["results"]
    assert area == {
        "id": "area", "value": 0.666666666666667, "unit": "deg^2", "reference": "Figure 5",
        "rule": "paper",
    }  # fmt: skip
    assert (count["value"], count["reference"], count["rule"]) == (6, "", "none")
    assert curves["value"] == ["β_{1,3,1}", "beta_{4,1,2}"]


def test_every_number_keeps_at_least_twelve_digits(tmp_path: Path) -> None:
    assert DIGITS >= 12
    content = json.loads(example().save(tmp_path).read_text(encoding="utf-8"))
    assert content["results"][1]["value"] == [
        [0.333333333333333, -1e-7],
        [0.1, 123456.789012346],
    ]


@given(st.floats(-1e300, 1e300, allow_subnormal=False))
def test_a_number_is_rounded_to_fifteen_digits_and_no_further(number) -> None:
    results = Results("x")
    results.add("n", number, "1")
    (entry,) = results.entries
    assert entry["value"] == pytest.approx(number, rel=1e-14)
    assert float(f"{number:.15g}") == entry["value"]


def test_the_last_noisy_digit_does_not_reach_the_file(tmp_path: Path) -> None:
    """0.1 + 0.2 and 0.3 are one result."""
    for name, value in (("one", 0.1 + 0.2), ("two", 0.3)):
        results = Results("x")
        results.add("n", value, "1")
        results.save(tmp_path / name)
    assert (tmp_path / "one/x.json").read_bytes() == (tmp_path / "two/x.json").read_bytes()


def test_same_bytes_on_a_second_run(tmp_path: Path) -> None:
    first = example().save(tmp_path).read_bytes()
    assert example().save(tmp_path).read_bytes() == first
    assert first.endswith(b"\n")
    assert "β".encode() in first
    assert b"\r" not in first


def test_add_returns_the_value_itself() -> None:
    value = np.array([1.0, 2.0])
    assert Results("x").add("v", value, "cm") is value


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
    results.add("v", value, "1")
    assert json.dumps(results.entries[0]["value"]) == json.dumps(plain)


BAD = [np.nan, np.inf, -np.inf, [1.0, np.nan], np.array([[1, 2], [3, np.inf]])]


@pytest.mark.parametrize("value", BAD, ids=str)
def test_a_number_that_is_not_finite_is_refused(value) -> None:
    results = Results("x")
    with pytest.raises(ValueError, match="is no result"):
        results.add("v", value, "1")
    assert results.entries == []


def test_an_id_is_unique_within_its_chapter() -> None:
    results = example()
    with pytest.raises(ValueError, match="'area' is there already"):
        results.add("area", 1.0, "deg^2")
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
    changed.add("more", 1.0, "1")
    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", half)
        with pytest.raises(OSError, match="disk full"):
            changed.save(tmp_path)
    assert path.read_bytes() == before
    changed.save(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["region.json"]


def test_folder_is_the_argument_then_the_environment_then_the_project(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    project = tmp_path / "project"
    below = project / "notebooks" / "deep"
    below.mkdir(parents=True)
    (project / "pyproject.toml").touch()
    monkeypatch.chdir(below)
    monkeypatch.delenv("QBOUND_RESULTS", raising=False)
    assert example().save() == project / "results" / "region.json"
    monkeypatch.setenv("QBOUND_RESULTS", str(tmp_path / "elsewhere"))
    assert example().save() == tmp_path / "elsewhere" / "region.json"
    assert example().save(tmp_path / "here") == tmp_path / "here" / "region.json"


def test_without_a_project_results_stand_in_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("QBOUND_RESULTS", raising=False)
    if any((place / "pyproject.toml").exists() for place in tmp_path.parents):
        pytest.skip("the temporary folder stands inside a project")
    assert example().save() == tmp_path / "results" / "region.json"
