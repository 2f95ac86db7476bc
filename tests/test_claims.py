"""The ledger: one test an entry, named by its id, and what every entry must have."""

from __future__ import annotations

import ast
import re
import tomllib
from functools import cache
from pathlib import Path

import pytest

from qbound import paper
from qbound.claims import judge, undetermined
from qbound.claims.ledger import KINDS, VERDICTS, claim, identifiers

ROOT = Path(__file__).resolve().parent.parent
EXPECTED = tomllib.loads((ROOT / "tests" / "verdicts.toml").read_text(encoding="utf-8"))
VERDICT = {name: verdict for kind in EXPECTED.values() for name, verdict in kind.items()}
KIND = {name: kind for kind, names in EXPECTED.items() for name in names}

every_id = pytest.mark.parametrize("name", identifiers())


@cache
def computed(name: str):
    return claim(name)


# --- each entry -----------------------------------------------------------------------------------


@every_id
def test_verdict(name: str) -> None:
    """The verdict that the computation gives is the one that we came to by thinking."""
    assert computed(name).verdict == VERDICT[name], computed(name).found


@every_id
def test_entry_says_what_was_found_and_where(name: str) -> None:
    found = computed(name)
    assert found.kind == KIND[name]
    assert found.where
    for text in (found.says, found.found):
        assert text.strip() == text
        assert not re.search(r"\\|\$|\bnan\b|\binf\b", text), "plain text, finite numbers"
        assert text.endswith(".")
    assert bool(found.mended) or found.verdict not in ("misprint", "refuted")


@every_id
def test_the_test_of_an_entry_exists(name: str) -> None:
    file, test = re.fullmatch(r"(test_\w+\.py)::(test_\w+)", computed(name).evidence.test).groups()
    tree = ast.parse((ROOT / "tests" / file).read_text(encoding="utf-8"))
    assert test in {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


@every_id
def test_the_chapter_of_an_entry_exists(name: str) -> None:
    chapter, _, anchor = computed(name).evidence.chapter.partition("#")
    assert (ROOT / "notebooks" / f"{chapter}.md").exists()
    assert anchor


def test_every_expected_entry_is_on_the_list_and_no_other() -> None:
    assert set(VERDICT) == set(identifiers())
    assert len(VERDICT) == sum(len(names) for names in EXPECTED.values())
    assert tuple(EXPECTED) == KINDS
    assert set(VERDICT.values()) <= set(VERDICTS)


# --- what the paper has ---------------------------------------------------------------------------


def test_every_equation_of_the_paper_has_an_entry() -> None:
    assert [n for n in identifiers() if re.fullmatch(r"E-\d+", n)] == [
        f"E-{number}" for number in range(1, 40)
    ]


def test_every_bound_of_table_6_has_an_entry() -> None:
    labels = (re.sub(r"beta_\{(\d),(\d),(\d)\}", r"B-\1.\2.\3", b) for b in paper.TABLE_6)
    assert [n for n in identifiers() if n.startswith("B-")] == list(labels)
    assert len(paper.TABLE_6) == 22


@pytest.mark.parametrize(("table", "rows"), [(1, 4), (2, 6), (3, 6), (4, 3), (5, 6), (6, 11)])
def test_every_row_of_a_table_has_an_entry(table: int, rows: int) -> None:
    names = [f"T-{table}", *(f"T-{table}.{row}" for row in range(1, rows + 1))]
    assert [n for n in identifiers() if re.match(rf"T-{table}(\.|$)", n)] == names


# --- from outcome to verdict ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("outcome", "verdict"),
    [
        ({"holds": True}, "confirmed"),
        ({"holds": True, "under": True, "mended": True}, "confirmed"),
        ({"holds": False, "under": True}, "confirmed with a condition"),
        ({"holds": False, "mended": True}, "misprint"),
        ({"holds": False}, "refuted"),
    ],
)
def test_an_outcome_decides_the_verdict(outcome, verdict) -> None:
    assert judge(**outcome) == verdict


@pytest.mark.parametrize(
    ("fits", "verdict"),
    [
        ([True, True, False], "not determined by the paper"),
        ([True, False], "confirmed with a condition"),
        ([False, False], "refuted"),
    ],
)
def test_the_readings_that_fit_decide_the_verdict(fits, verdict) -> None:
    assert undetermined({str(i): fit for i, fit in enumerate(fits)}) == verdict
