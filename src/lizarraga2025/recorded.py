"""The book's results as recorded: read, not computed, from the package or from its repository.

A wheel carries a copy of ``results/``, made when it is built; in a working copy the folder itself
is read.
"""

from __future__ import annotations

import json
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

LEDGER = "claims.json"

HEAD = ("chapter", "version", "robots")
"""What an entry takes over from its file."""


def folder() -> Traversable:
    """Return the folder of the recorded results.

    Raises
    ------
    FileNotFoundError
        If there is neither a copy in the package nor a repository around it.
    """
    packaged = resources.files("lizarraga2025") / "recorded_results"
    repository = Path(__file__).resolve().parents[2] / "results"
    for place in (packaged, repository):
        if place.is_dir():
            return place
    raise FileNotFoundError("this installation carries no recorded results")


def results() -> list[dict[str, Any]]:
    """Return every recorded number: all chapters' entries, each with its chapter's head.

    That is ``chapter``, ``version`` and ``robots``, a hash each.
    """
    files = sorted((file for file in folder().iterdir() if _holds_results(file)), key=_name)
    content = [json.loads(file.read_text(encoding="utf-8")) for file in files]
    return [{**{key: c[key] for key in HEAD}, **entry} for c in content for entry in c["results"]]


def claims() -> list[dict[str, Any]]:
    """Return every recorded entry of the ledger.

    Raises
    ------
    FileNotFoundError
        If the ledger has not been written.
    """
    file = folder() / LEDGER
    if not file.is_file():
        raise FileNotFoundError(f"no {LEDGER} among the recorded results")
    entries: list[dict[str, Any]] = json.loads(file.read_text(encoding="utf-8"))["claims"]
    return entries


def _holds_results(file: Traversable) -> bool:
    return file.name.endswith(".json") and file.name != LEDGER


def _name(file: Traversable) -> str:
    return file.name
