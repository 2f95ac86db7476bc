"""The errata: which entries they list, in which parts, formulas as the paper prints them."""

from __future__ import annotations

import tomllib
from importlib import resources

import pytest

from lizarraga2025 import printed as paper
from lizarraga2025 import recorded
from lizarraga2025.ledger.claims import from_content
from lizarraga2025.ledger.errata import change, errata
from lizarraga2025.ledger.page import errata_list, ledger_table, typeset
from lizarraga2025.typeset import latex

LEDGER = [from_content(content) for content in recorded.claims()]
PARTS = errata(LEDGER)
FILE = resources.files("lizarraga2025") / "ledger" / "statements" / "errata.toml"


def test_all_that_does_not_hold_is_listed_once() -> None:
    listed = [one.id for entries in PARTS.values() for one in entries]
    assert len(set(listed)) == len(listed)
    assert {one.id for one in LEDGER if one.verdict in ("misprint", "refuted")} <= set(listed)
    assert not {one.id for one in LEDGER if one.verdict == "confirmed"} & set(listed)


def test_the_errata_print_nothing_that_the_ledger_does_not_hold() -> None:
    """No rule of this arm for every robot, no cause that is none, no unit that is open."""
    assert "S-30.1" not in {one.id for entries in PARTS.values() for one in entries}
    assert not {"T-5", "T-5.1", "T-5.2"} & {one.id for one in PARTS["T-4.1"]}
    assert "Table 5" not in change("T-4.1")[0]
    assert "third" not in change("E-9")[1]
    assert "due to" not in change("F-10.2")[1]


def test_the_inverse_tangent_has_its_part() -> None:
    assert {"E-34", "T-6.3", "T-6.6", "B-2.1.1", "B-3.3.2"} <= {one.id for one in PARTS["E-34"]}


@pytest.mark.parametrize("leader", PARTS)
def test_a_part_is_one_finding(leader: str) -> None:
    assert len({one.finding for one in PARTS[leader]}) == 1
    assert leader in {one.id for one in PARTS[leader]}


def test_every_typed_change_leads_a_part() -> None:
    assert set(tomllib.loads(FILE.read_text(encoding="utf-8"))) <= set(PARTS)


@pytest.mark.parametrize("leader", [name for name in PARTS if name.startswith("T-6.")])
def test_a_row_of_table_6_changes_a_sign_of_the_printed_bounds(leader: str) -> None:
    printed, proposed = change(leader)
    bounds = [one.id.removeprefix("B-").split(".") for one in PARTS[leader] if one.kind == "bound"]
    labels = ["beta_{{{},{},{}}}".format(*indices) for indices in bounds]
    assert printed.splitlines() == [rf"$\{b} = {latex(paper.TABLE_6[b])}$" for b in labels]
    assert proposed == printed.replace(r"- \cos^{-1}", r"+ \cos^{-1}") != printed


def test_tex_between_dollar_signs_is_handed_to_the_script_and_all_else_is_escaped() -> None:
    assert typeset("<b> $a < b$ q_1") == (
        '&lt;b&gt; <span class="math notranslate">\\(a &lt; b\\)</span> q<sub>1</sub>'
    )


def test_the_pages_of_an_empty_ledger_are_empty() -> None:
    assert "<dl" not in errata_list({})
    assert "0 statements of the paper, 0 findings" in ledger_table([])
