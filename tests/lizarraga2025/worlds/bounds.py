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


CHANGES = {
    ("+ acos", "- acos"): "1.1.1",
    ("acos", "-acos"): "1.1.2",
    (
        "- acos",
        "+ acos",
    ): "1.3.1 1.3.2 2.3.1 2.3.2 3.1.1 3.1.2 4.1.1 4.1.2 4.3.1 4.3.2 5.1.1 5.1.2 6.1.1 6.1.2",
    ("arctan", "atan2"): "2.1.1 2.1.2 3.3.1 3.3.2",
    ("- q1", "+ q1"): "7.3.1",
    ("- asin", "+ asin"): "7.3.2",
}
"""What stands in bounds of Table 6, what stands there in their world, and their numbers."""

WORLDS: dict[str, World] = {
    f"B-{ijk}": with_bound(ijk, *change)
    for change, bounds in CHANGES.items()
    for ijk in bounds.split()
}
