"""Results that can be cited: one JSON file a chapter, written by the chapter's own run."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from qbound.files import write_whole

DIGITS = 15
"""Digits that are written, as many as a double holds without its last, noisy one."""


class Results:
    """The numbers that one chapter states.

    Parameters
    ----------
    chapter : str
        Name of the file, without ``.json``.
    """

    def __init__(self, chapter: str) -> None:
        self.chapter = chapter
        self.entries: list[dict[str, Any]] = []

    def add(
        self, name: str, value: Any, unit: str, *, reference: str = "", rule: str = "none"
    ) -> Any:
        """Note a number, a vector or a text, and return it.

        Parameters
        ----------
        name : str
            The result's id: stable, unique within the chapter.
        value : float, int, str, or array_like
        unit : str
            ``deg``, ``cm``, ``cm^2``, ``deg^2``, ``rad^2``; ``1`` for a pure number or a name.
        reference : str
            What it belongs to in the paper, such as "Figure 5" or "eq. 31".
        rule : {"paper", "clearance", "none"}
            Rule of the region that it rests on.

        Raises
        ------
        ValueError
            If the id is taken or a number is not finite.
        """
        if any(entry["id"] == name for entry in self.entries):
            raise ValueError(f"the result {name!r} is there already")
        plain = _plain(value)
        entry = {"id": name, "value": plain, "unit": unit, "reference": reference, "rule": rule}
        self.entries.append(entry)
        return value

    def save(self, folder: str | Path | None = None) -> Path:
        """Write ``<chapter>.json``, complete or not at all, and return its path.

        The folder is `folder`, else the environment's QBOUND_RESULTS, else ``results`` beside the
        nearest pyproject.toml at or above the working directory, else ``results`` in it.
        """
        content = {"schema": "qbound/results/1", "chapter": self.chapter, "results": self.entries}
        return write_json(self.chapter, content, folder)


def write_json(name: str, content: Any, folder: str | Path | None = None) -> Path:
    """Write ``<name>.json``, complete or not at all, into the folder that `Results.save` names."""
    target = _folder(folder) / f"{name}.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    write_whole(target, text.encode())
    return target


def _folder(folder: str | Path | None) -> Path:
    chosen = folder or os.environ.get("QBOUND_RESULTS")
    if chosen:
        return Path(chosen)
    here = Path.cwd()
    roots = (place for place in (here, *here.parents) if (place / "pyproject.toml").exists())
    return next(roots, here) / "results"


def _plain(value: Any) -> Any:
    """Turn arrays and NumPy scalars into lists and numbers that JSON knows."""
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, str | bool | int) or value is None:
        return value
    if isinstance(value, Sequence):
        return [_plain(item) for item in value]
    number = float(value)
    if not np.isfinite(number):
        raise ValueError(f"{number} is no result")
    return float(f"{number:.{DIGITS}g}")
