"""Every entry of the ledger can turn: in some world its computation comes to another verdict."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.claims import claim, identifiers
from support.worlds import World, robot_file, with_points, world
from worlds import WORLDS

EXPECTED = tomllib.loads((Path(__file__).parent / "verdicts.toml").read_text(encoding="utf-8"))
VERDICT = {
    name: verdict if isinstance(verdict, str) else verdict[1]
    for kind in EXPECTED.values()
    for name, verdict in kind.items()
}
"""Of the most favourable reading."""


BY_WORLD: dict[World, list[str]] = {}
for NAME in identifiers():
    BY_WORLD.setdefault(WORLDS[NAME], []).append(NAME)


@pytest.mark.parametrize("names", BY_WORLD.values(), ids=" ".join)
def test_in_another_world_entries_have_other_verdicts(names: list[str]) -> None:
    """A world is entered once for all entries that turn in it: what they share is found once."""
    with WORLDS[names[0]]():
        assert [name for name in names if claim(name).most_favourable == VERDICT[name]] == []


def test_no_world_is_of_an_unknown_entry_and_none_is_missing() -> None:
    assert set(WORLDS) == set(identifiers())


def test_a_world_forgets_what_was_computed_before_and_inside_even_after_an_error() -> None:
    before = claim("E-17.4").most_favourable
    moved = with_points(robot_file(), p13=(9.09, 0.0, 5.25))
    with world(robots={"minervabot-v2": moved})():
        assert claim("E-17.4").most_favourable != before
    with pytest.raises(ValueError, match="no claim"), world(robots={"minervabot-v2": moved})():
        claim("B-0")
    assert claim("E-17.4").most_favourable == before


def test_what_was_found_is_told_of_the_world_it_was_found_in() -> None:
    label = "beta_{2,3,1}"
    text = paper.TABLE_6[label].replace("pi + ", "")
    assert "a root of the component" in claim("B-2.3.1").computed
    with world(printed={"TABLE_6": {label: text}})():
        assert "no root (20.00 cm) of the component" in claim("B-2.3.1").computed
