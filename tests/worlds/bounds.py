"""Worlds in which the entries of ``statements/bounds.toml`` come to other verdicts."""

from __future__ import annotations

from support.worlds import World

WORLDS: dict[str, World] = {}

MISSING: list[str] = [
    "B-1.1.1",
    "B-1.1.2",
    "B-1.3.1",
    "B-1.3.2",
    "B-2.1.1",
    "B-2.1.2",
    "B-2.3.1",
    "B-2.3.2",
    "B-3.1.1",
    "B-3.1.2",
    "B-3.3.1",
    "B-3.3.2",
    "B-4.1.1",
    "B-4.1.2",
    "B-4.3.1",
    "B-4.3.2",
    "B-5.1.1",
    "B-5.1.2",
    "B-6.1.1",
    "B-6.1.2",
    "B-7.3.1",
    "B-7.3.2",
]
"""Ids that have no world yet."""
