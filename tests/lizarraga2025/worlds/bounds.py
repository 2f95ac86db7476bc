"""Worlds in which the entries of ``statements/bounds.toml`` come to other verdicts."""

from __future__ import annotations

from lizarraga2025 import printed as paper
from support.worlds import World, world


def with_bound(ijk: str, old: str, new: str) -> World:
    """Return the world that prints a bound of Table 6 otherwise."""
    label = f"beta_{{{ijk.replace('.', ',')}}}"
    text = paper.TABLE_6[label]
    assert old in text
    return world(printed={"TABLE_6": {label: text.replace(old, new, 1)}})


WORLDS: dict[str, World] = {
    "B-1.1.1": with_bound("1.1.1", "+ acos", "- acos"),
    "B-1.1.2": with_bound("1.1.2", "acos", "-acos"),
    "B-1.3.1": with_bound("1.3.1", "- acos", "+ acos"),
    "B-1.3.2": with_bound("1.3.2", "- acos", "+ acos"),
    "B-2.1.1": with_bound("2.1.1", "arctan", "atan2"),
    "B-2.1.2": with_bound("2.1.2", "arctan", "atan2"),
    "B-2.3.1": with_bound("2.3.1", "- acos", "+ acos"),
    "B-2.3.2": with_bound("2.3.2", "- acos", "+ acos"),
    "B-3.1.1": with_bound("3.1.1", "- acos", "+ acos"),
    "B-3.1.2": with_bound("3.1.2", "- acos", "+ acos"),
    "B-3.3.1": with_bound("3.3.1", "arctan", "atan2"),
    "B-3.3.2": with_bound("3.3.2", "arctan", "atan2"),
    "B-4.1.1": with_bound("4.1.1", "- acos", "+ acos"),
    "B-4.1.2": with_bound("4.1.2", "- acos", "+ acos"),
    "B-4.3.1": with_bound("4.3.1", "- acos", "+ acos"),
    "B-4.3.2": with_bound("4.3.2", "- acos", "+ acos"),
    "B-5.1.1": with_bound("5.1.1", "- acos", "+ acos"),
    "B-5.1.2": with_bound("5.1.2", "- acos", "+ acos"),
    "B-6.1.1": with_bound("6.1.1", "- acos", "+ acos"),
    "B-6.1.2": with_bound("6.1.2", "- acos", "+ acos"),
    "B-7.3.1": with_bound("7.3.1", "- q1", "+ q1"),
    "B-7.3.2": with_bound("7.3.2", "- asin", "+ asin"),
}
