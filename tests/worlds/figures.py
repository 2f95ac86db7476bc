"""Worlds in which the entries of ``statements/figures.toml`` come to other verdicts."""

from __future__ import annotations

from support.worlds import World

WORLDS: dict[str, World] = {}

MISSING: list[str] = [
    "F-1",
    "F-2",
    "F-3",
    "F-4.1",
    "F-4.2",
    "F-4.3",
    "F-5.1",
    "F-5.2",
    "F-6.1",
    "F-6.2",
    "F-6.3",
    "F-6.4",
    "F-7.1",
    "F-7.2",
    "F-8.1",
    "F-8.2",
    "F-9",
    "F-10.1",
    "F-10.2",
    "F-10.3",
    "F-10.4",
    "F-11.1",
    "F-11.2",
    "F-11.3",
    "F-11.4",
]
"""Ids that have no world yet."""
