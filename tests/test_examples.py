"""Examples run, whatever a newcomer calls first has one, and no module is left out of the books."""

import doctest
import importlib
import inspect
import re
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest

import cspace
import lizarraga2025
import qbound
from lizarraga2025.exercises import UNFILLED, check

ROOTS = [Path(package.__file__).parents[1] for package in (cspace, lizarraga2025, qbound)]
API = Path(__file__).parents[1] / "book" / "api.md"
FILES = {
    ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
    for root, package in zip(ROOTS, ("cspace", "lizarraga2025", "qbound"), strict=True)
    for path in (root / package).rglob("*.py")
}
MODULES = sorted(name for name, path in FILES.items() if ">>>" in path.read_text(encoding="utf-8"))
PACKAGES = sorted(name for name, path in FILES.items() if path.name == "__init__.py")
ON_A_PAGE_OF_THEIR_PACKAGE = (
    "cspace.cli",
    "lizarraga2025.beyond",
    "lizarraga2025.commands",
    "lizarraga2025.computations",
    "lizarraga2025.beyond",
    "lizarraga2025.evidence",
    "lizarraga2025.ledger",
)
METHODS = [
    name
    for name, _ in inspect.getmembers(cspace.Region, inspect.isfunction)
    if not name.startswith("_")
]


@pytest.mark.parametrize("name", MODULES)
def test_examples_show_what_the_calls_return(name) -> None:
    failed, tried = doctest.testmod(importlib.import_module(name))
    assert tried
    assert not failed


def test_everything_at_the_front_door_and_every_method_of_a_region_has_an_example() -> None:
    named = [(at, name) for at in (cspace, qbound) for name in at.__all__]
    named += [(cspace.Region, name) for name in METHODS]
    assert [name for at, name in named if ">>>" not in (getattr(at, name).__doc__ or "")] == []


def test_the_first_calls_of_the_api_page_return_what_it_shows() -> None:
    matplotlib.use("agg")  # the page calls `plot` without axes: no window shall open
    page = API.read_text(encoding="utf-8").replace("```", "")  # a fence would belong to the output
    examples = doctest.DocTestParser().get_doctest(page, {}, API.name, str(API), 0)
    failed, tried = doctest.DocTestRunner().run(examples)
    assert tried > 10
    assert not failed


def test_the_docstring_of_a_package_lists_its_modules() -> None:
    for name in PACKAGES:
        said = set(re.findall(r"`(\w+)`", importlib.import_module(name).__doc__ or ""))
        inside = {each.rpartition(".")[2] for each in FILES if each.rpartition(".")[0] == name}
        assert inside - {"__main__"} <= said, name


def test_the_api_page_lists_every_module_once_and_no_other() -> None:
    listed = re.findall(
        r"^   ((?:cspace|lizarraga2025|qbound)[.\w]+)$", API.read_text("utf-8"), re.MULTILINE
    )
    inside = tuple(f"{name}." for name in ON_A_PAGE_OF_THEIR_PACKAGE)
    modules = {name for name in FILES if not name.endswith(".__main__")} - set(PACKAGES)
    modules -= {"cspace.check"}  # a file to read
    assert len(set(listed)) == len(listed)
    assert set(listed) <= set(FILES)
    assert {name for name in modules if not name.startswith(inside)} <= set(listed)
    assert set(ON_A_PAGE_OF_THEIR_PACKAGE) <= set(listed)


def test_there_are_modules_and_methods_to_look_at() -> None:
    assert {"cspace.region.region", "cspace.proofs.certificates.certify"} <= set(MODULES)
    assert {"margins", "contains", "plot", "to_dict"} <= set(METHODS)


# --- the cells of exercises -----------------------------------------------------------------------


@pytest.mark.parametrize("expected", [6, 0.964, "home", True, {1, 2}, [1.0, 2.0], np.zeros((2, 2))])
def test_three_dots_are_no_answer(expected: Any) -> None:
    assert check(..., expected) == UNFILLED


@pytest.mark.parametrize(
    ("answer", "expected", "within"),
    [
        (6, 6, 0),
        (0.96, 0.964038, 0.005),
        ([1, 2], np.array([1.001, 1.999]), 0.01),
        (np.array([1.0]), [1], 0),
        ("home", "home", 0),
        (True, True, 0),
        ({"B7", "B3"}, {"B3", "B7"}, 0),
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
        ([1, 2], [1, 3], 0, "Not yet."),
        ([1, 2, 3], [1, 3], 0, "2 numbers are asked for"),
        ("six", 6, 0, "a number is asked for"),
        ([[1], [1, 2]], [1, 2], 0, "a number is asked for"),
        (1 + 2j, 1.0, 5, "a number is asked for"),
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
