"""Results that can be cited: one JSON file a chapter, written by the chapter's own run.

Each number states its error, and is written with the digits that this error allows.
"""

import hashlib
import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from lizarraga2025 import __version__
from lizarraga2025.recorded import input_uncertainties
from qbound.robotfile import ROBOTS

SCHEMA: Final = "qbound/results/3"

EXACT: Final = 0.0
"""Error of a count, a name, or a decimal that is meant as it is written."""

EXACT_DIGITS: Final = 12
"""A decimal of more digits than these was computed: it has an error, and has to state it."""


def rounding(size: float) -> float:
    """Bound what doubles leave in a formula of this size: a hundred of its half units.

    The formulas of the book take some tens of operations on offsets and angles; each is right to
    half a unit in the last place of its largest term.
    """
    return 100 * 2.0**-53 * abs(size)


ANGLE: Final = rounding(360)
"""Error of an angle in degrees that a closed form gives, at simple roots."""

LENGTH: Final = rounding(100)
"""Error of a length in cm that a closed form gives."""

RATIO: Final = rounding(1)
"""Error of a pure number near one."""


def area_error(*areas: float) -> float:
    """Bound the error of areas: 1e-12 of their sum.

    Both packages are within it: a test finds the areas of a hundred arms by each.
    """
    return 1e-12 * float(np.sum(np.abs(areas)))


def last_place(*numbers: str) -> float:
    """Return a unit of the last decimal place of numbers that are written out."""
    return float(max(10.0 ** -len(number.partition(".")[2]) for number in numbers))


def grid_error(inside: NDArray[np.bool_], cell: float) -> float:
    """Bound the error of an area that was counted on a grid of one turn of both joints.

    A cell whose neighbours answer alike is taken for what its middle says; the others may be in or
    out. What is smaller than a cell and missed by every middle is not seen.

    Parameters
    ----------
    inside : ndarray of bool, shape (n, n)
        The answer at the middle of each cell.
    cell : float
        Area of a cell.
    """
    beside = [inside != np.roll(inside, step, axis) for axis in (0, 1) for step in (1, -1)]
    return float(cell * np.any(beside, axis=0).sum())


class Results:
    """The numbers that one chapter states.

    Parameters
    ----------
    chapter : str
        Name of the file, without ``.json``.
    *robots : str
        Names of the paper's robots that the numbers are about.
    """

    def __init__(self, chapter: str, *robots: str) -> None:
        self.chapter = chapter
        self.robots: dict[str, str] = {}
        self.entries: list[dict[str, Any]] = []
        for name in robots:
            self.about(name, (ROBOTS / f"{name}.toml").read_text(encoding="utf-8"))

    def about(self, name: str, text: str) -> None:
        """Name one more robot by the text of its file: its hash, as a certificate states it."""
        self.robots[name] = hashlib.sha256(text.encode()).hexdigest()

    def add(
        self,
        name: str,
        value: Any,
        unit: str,
        *,
        numerical_error: float,
        reference: str = "",
        reading: str = "none",
    ) -> Any:
        """Note a number, a vector or a text, and return it.

        What the printed digits leave open of it is looked up by its id: see `recorded`.

        Parameters
        ----------
        name : str
            The result's id: stable, and of one meaning in the whole project.
        value : float, int, str, or array_like
        unit : str
            ``deg``, ``cm``, ``cm^2``, ``deg^2``, ``rad^2``; ``1`` for a pure number or a name.
        numerical_error : float
            Bound of the error of the arithmetic, of each number, in `unit`; `EXACT` for a count, a
            name or an exact decimal. It decides the digits that are written, and their rounding is
            added to it.
        reference : str
            What it belongs to in the paper, such as "Figure 5" or "eq. 31".
        reading : {"windows", "clearance", "none"}
            Reading of the boundary functions that the region of the number rests on.

        Raises
        ------
        ValueError
            If the id is taken, a number is not finite, or the error is none or cannot be.
        """
        if any(entry["id"] == name for entry in self.entries):
            raise ValueError(f"the result {name!r} is there already")
        if not (math.isfinite(numerical_error) and numerical_error >= 0):
            raise ValueError(f"{name}: {numerical_error} is no bound of an error")
        plain = _plain(value)
        error = max(numerical_error, _resolution(plain)) if numerical_error else EXACT
        entry = {"id": name, "value": _rounded(plain, error), "unit": unit, "reference": reference}
        entry |= {"reading": reading, "numerical_error": _with_rounding(plain, error)}
        studied = input_uncertainties().get(name, {})
        self.entries.append(entry | {"input_uncertainty": studied.get("input_uncertainty")})
        return value

    def save(self, folder: str | Path | None = None) -> Path | None:
        """Write ``<chapter>.json``, complete or not at all, and return its path.

        The folder is `folder`, else the environment's QBOUND_RESULTS, which the build of the book
        sets. Without either nothing is written, and a line says so: whoever tries things in a
        chapter changes no recorded result.
        """
        head = {"schema": SCHEMA, "version": __version__, "robots": self.robots}
        content = head | {"chapter": self.chapter, "results": self.entries}
        chosen = folder or os.environ.get("QBOUND_RESULTS")
        if not chosen:
            print(f"{self.chapter}.json is not written: results are recorded with the book.")
            return None
        return write_json(Path(chosen) / f"{self.chapter}.json", content)


def write_json(file: Path, content: Any) -> Path:
    """Write a file, complete or not at all, and return its path; its folder is made."""
    file.parent.mkdir(parents=True, exist_ok=True)
    draft = file.with_name(f".{file.name}.part")
    text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    draft.write_text(text, encoding="utf-8", newline="\n")
    return draft.replace(file)


# --- a result and its earlier self ----------------------------------------------------------------


def share_of_error(now: Mapping[str, Any], then: Mapping[str, Any]) -> float:
    """Return by which part of its stated error a recorded result differs from its earlier self.

    They agree up to 1. The share is infinite where another thing was recorded: another unit,
    count, text or number of values, or an error that is another one by more than a tenth.
    """
    fixed = [
        {k: v for k, v in one.items() if k not in ("value", "numerical_error")}
        for one in (now, then)
    ]
    stated = then["numerical_error"]
    is_same = fixed[0] == fixed[1] and _without_floats(now["value"]) == _without_floats(
        then["value"]
    )
    if not is_same or not math.isclose(now["numerical_error"], stated, rel_tol=0.1):
        return math.inf
    pairs = zip(_floats(now["value"]), _floats(then["value"]), strict=True)
    apart = max((abs(a - b) for a, b in pairs), default=0.0)
    if apart == 0:
        return 0.0
    return apart / stated if stated else math.inf


def _without_floats(value: Any) -> Any:
    """Return a value with its floats alike: what is left is compared as it is."""
    if isinstance(value, list):
        return [_without_floats(item) for item in value]
    return None if isinstance(value, float) else value


# --- numbers and their digits ---------------------------------------------------------------------


def _plain(value: Any) -> Any:
    """Turn arrays and NumPy scalars into lists and numbers that JSON knows."""
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, str | bool | int):
        return value
    if isinstance(value, Sequence):
        return [_plain(item) for item in value]
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{number} is no result")
    return number


def places(error: float) -> int:
    """Return the decimal places that an error allows: the last one is at most twice the error."""
    return -math.floor(math.log10(2 * error))


def _rounded(value: Any, error: float) -> Any:
    """Round every float to the places that the error allows; an exact one stays as it is."""
    if isinstance(value, list):
        return [_rounded(item, error) for item in value]
    if not isinstance(value, float):
        return value
    if error:
        return round(value, places(error)) + 0.0  # no -0.0
    if float(f"{value:.{EXACT_DIGITS}g}") != value:
        raise ValueError(f"{value!r} is no exact decimal: state its error")
    return value


def _with_rounding(value: Any, error: float) -> float:
    """Add half of the last place that is written, and round up to two digits."""
    if not error or not _floats(value):
        return error
    return rounded_up(error + 10.0 ** -places(error) / 2)


def rounded_up(error: float) -> float:
    """Return the next number of two digits."""
    place = math.floor(math.log10(error)) - 1
    return float(f"{math.ceil(error * 10.0**-place - 1e-9)}e{place}")


def _resolution(value: Any) -> float:
    """Return the distance of doubles at the largest number: no digit below it means anything."""
    return max((float(np.spacing(abs(number))) for number in _floats(value)), default=0.0)


def _floats(value: Any) -> list[float]:
    if isinstance(value, list):
        return [number for item in value for number in _floats(item)]
    return [value] if isinstance(value, float) else []
