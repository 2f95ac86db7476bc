"""Nothing that was recorded leaves or changes without a line that says why."""

from __future__ import annotations

import json

import pytest

from baseline import RECORD, compare, differences

OLD = {
    "results/region/area": {"value": [11.75, 2.0], "error": 0.01},
    "claims/E-1": "confirmed",
    "commands/region arm": 0,
    "keys/region arm": ["area"],
}
GONE = {"which": "commands/region arm", "old": 0, "new": "gone", "why": "cut"}
CHANGED = {"which": "results/region/area", "old": [11.75, 2.0], "new": [11.9, 2.0], "why": "wrong"}


def test_all_of_the_baseline_is_there():
    assert compare(quick=True) == []


def test_the_baseline_has_what_was_recorded_when_it_was_made():
    families = [address.partition("/")[0] for address in json.loads(RECORD.read_text("utf-8"))]
    counts = {name: families.count(name) for name in sorted(set(families))}
    assert counts == {
        "claims": 233, "commands": 37, "keys": 30, "pages": 40, "results": 614, "traceability": 58
    }  # fmt: skip


MOVED = {"which": "claims/E-1", "old": "confirmed", "new": "claims/E-9", "why": "renamed"}
INDEPENDENT = CHANGED | {"independent": "a grid"}


def area(*value, error=0.01):
    return {"results/region/area": {"value": [*value], "error": error}}


@pytest.mark.parametrize(
    ("changes", "lines", "fault"),
    [
        ({}, [], ""),
        (area(11.755, 2.0), [], ""),
        (area(11.765, 2.0), [], "now"),
        (area(11.75, 2.0, error=0.02), [], "now"),
        (area(11.75), [], "now"),
        ({"results/region/area": None}, [], "gone, was"),
        ({"claims/E-1": "refuted"}, [], "now refuted"),
        ({"commands/region arm": None, "keys/region arm": None}, [GONE], ""),
        ({}, [GONE], "still there"),
        ({"commands/region arm": None}, [GONE | {"old": 1}], "was 0"),
        (area(11.9, 2.0), [CHANGED], "independent"),
        (area(11.9, 2.0), [INDEPENDENT], ""),
        ({}, [INDEPENDENT], "as retired.toml says"),
        ({}, [GONE | {"which": "claims/E-2"}], "not in the baseline"),
        ({"claims/E-1": None, "claims/E-9": "confirmed"}, [MOVED], ""),
        ({"claims/E-1": None, "claims/E-9": "refuted"}, [MOVED], "now refuted"),
    ],
)
def test_what_leaves_or_changes_needs_a_line_that_is_true(changes, lines, fault):
    now = {address: value for address, value in (OLD | changes).items() if value is not None}
    faults = list(differences(OLD, now, lines))
    assert bool(faults) == bool(fault)
    assert fault in "".join(faults)
