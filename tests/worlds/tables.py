"""Worlds in which the entries of ``statements/tables.toml`` come to other verdicts."""

from __future__ import annotations

from support.worlds import World

WORLDS: dict[str, World] = {}

MISSING: list[str] = [
    "T-1",
    "T-1.1",
    "T-1.2",
    "T-1.3",
    "T-1.4",
    "T-2",
    "T-2.1",
    "T-2.2",
    "T-2.3",
    "T-2.4",
    "T-2.5",
    "T-2.6",
    "T-3",
    "T-3.1",
    "T-3.2",
    "T-3.3",
    "T-3.4",
    "T-3.5",
    "T-3.6",
    "T-4",
    "T-4.1",
    "T-4.2",
    "T-4.3",
    "T-5",
    "T-5.1",
    "T-5.2",
    "T-5.3",
    "T-5.4",
    "T-5.5",
    "T-5.6",
    "T-6",
    "T-6.1",
    "T-6.2",
    "T-6.3",
    "T-6.4",
    "T-6.5",
    "T-6.6",
    "T-6.7",
    "T-6.8",
    "T-6.9",
    "T-6.10",
    "T-6.11",
]
"""Ids that have no world yet."""
