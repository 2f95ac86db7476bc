"""What was measured side by side with other tools: read, not measured, as it is committed.

`python3 run.py bench` asks everybody and writes ``engine/benchmarks/side_by_side.json``; a wheel
carries a copy. The book reads that file alone, so that making it again changes no number.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from importlib.resources.abc import Traversable
from itertools import product
from pathlib import Path
from typing import Any, Final

SCHEMA: Final = "qbound/side-by-side/1"
NAME: Final = "side_by_side.json"

OURS: Final = "qbound"
"""How the names of our own peers begin."""

VERDICTS: Final[dict[bool | None, str]] = {True: "met", False: "missed", None: "open"}


@dataclass(frozen=True)
class Measured:
    """The answer of one peer to one request.

    Attributes
    ----------
    id, task, scene, label : str
        What was asked; the label tells requests of one task and scene apart.
    peer : str
        Who was asked.
    seconds, low, high, processor : float or None
        Median, least and most of the rounds' wall time, median of the processor time; None where
        there was no answer.
    rounds : tuple of float
        The wall times.
    answer : mapping
        What the file keeps of the answer.
    missing, refused, over : str, str, float or None
        Why there was none: not installed, refused, or stopped after so many seconds.
    measured : str
        Day of the measurement.
    retired : bool
        Whether the request is made no longer, so that this is the last measurement of it.
    """

    id: str
    task: str
    scene: str
    label: str
    peer: str
    seconds: float | None = None
    low: float | None = None
    high: float | None = None
    processor: float | None = None
    rounds: tuple[float, ...] = ()
    answer: dict[str, Any] = field(default_factory=dict)
    missing: str = ""
    refused: str = ""
    over: float | None = None
    measured: str = ""
    retired: bool = False

    @property
    def why(self) -> str:
        """Why there was no answer, in words; empty where there was one."""
        words = {"missing": self.missing, "refused": self.refused}
        found = next((f"{word}: {reason}" for word, reason in words.items() if reason), "")
        return found if found or self.over is None else f"over {self.over:g} s"

    @property
    def is_ours(self) -> bool:
        """Whether it is this project's."""
        return self.peer.startswith(OURS)

    @property
    def quality(self) -> Mapping[str, Any]:
        """How good an answer about a region is; nothing where none was compared.

        Of the one component that the peer looks for, where it looks for no other.
        """
        found: Mapping[str, Any] = self.answer.get("own", self.answer.get("all", {}))
        return found

    @property
    def rate(self) -> float:
        """How many of what the answer counts a second; ValueError where there was no answer."""
        if self.seconds is None:
            raise ValueError(f"{self.id}: {self.why}")
        return float(self.answer["count"]) / self.seconds


@dataclass(frozen=True)
class Comparison:
    """All that was measured in one run, and the last measurements of what is asked no longer.

    Attributes
    ----------
    date : str
        Day of the run.
    quick : bool
        Whether it was a trial run, with less of everything.
    machine : mapping
        Processor, cores, memory (bytes), system.
    measurements : tuple of Measured
    goals : tuple of mapping
        Each with ``id``, ``part``, ``text``, ``goal``, ``sense``, ``ours``, ``theirs``, ``ratio``,
        ``met`` (None where it is open, with a ``why``).
    """

    date: str
    quick: bool
    machine: Mapping[str, Any]
    measurements: tuple[Measured, ...]
    goals: tuple[Mapping[str, Any], ...]

    def of(self, task: str, scene: str | None = None, label: str | None = None) -> list[Measured]:
        """Return what was answered about a task, of one scene and label or of all, fastest first.

        Examples
        --------
        >>> found = side_by_side()
        >>> all(one.seconds <= other.seconds for one, other in zip(*[iter(found.of("one"))] * 2))
        True
        >>> found.of("no such task")
        []
        """
        chosen = [
            each
            for each in self.measurements
            if each.task == task
            and scene in (None, each.scene)
            and label in (None, each.label)
            and each.seconds is not None
        ]
        return sorted(chosen, key=lambda each: each.seconds or 0.0)

    def spread(self, goal: Mapping[str, Any]) -> float:
        """Return how far the ratio of a goal may be off, by what the rounds of both times say.

        The ratio is the median over rounds that both were asked in. The farthest round counts when
        the least and the greatest are left out: of seven rounds, these bracket the true median in
        seven cases of eight. Where one was asked more often than the other, any two rounds are
        compared. It is 0 where no times are: other answers are the same in every round.

        Examples
        --------
        >>> found = side_by_side()
        >>> goal = next(goal for goal in found.goals if goal["id"] == "streams-compiled-pinocchio")
        >>> 0 < found.spread(goal) < goal["ratio"]
        True
        """
        if goal["quantity"] != "seconds":
            return 0.0
        of = {each.id: each.rounds for each in self.measurements}
        ours, theirs = (of[name] for name in goal["of"])
        same = len(ours) == len(theirs)
        pairs = zip(theirs, ours, strict=True) if same else product(theirs, ours)
        inner = sorted(their / our for their, our in pairs)[1:-1]
        ratio = float(goal["ratio"])
        return max(ratio - inner[0], inner[-1] - ratio)


def side_by_side(file: Path | None = None) -> Comparison:
    """Read the committed measurements, or those of another file.

    Raises
    ------
    FileNotFoundError
        If there is neither a copy in the package nor a repository around it.
    ValueError
        If the file has another schema.
    """
    source = file or _committed()
    told = json.loads(source.read_text(encoding="utf-8"))
    if not isinstance(told, dict) or told.get("schema") != SCHEMA:
        raise ValueError(f"{source.name}: this is no {SCHEMA}")
    retired = told["retired"]
    rows = [each | {"measured": told["date"]} for each in told["measurements"]]
    rows += [each | {"retired": True} for each in retired["measurements"]]
    return Comparison(
        told["date"],
        told["quick"],
        told["machine"],
        tuple(Measured(**row) for row in rows),
        tuple(told["goals"]),
    )


def _committed() -> Traversable:
    packaged = resources.files("lizarraga2025") / NAME
    repository = Path(__file__).resolve().parents[2] / "engine" / "benchmarks" / NAME
    for place in (packaged, repository):
        if place.is_file():
            return place
    raise FileNotFoundError("this installation carries no measurements")


def times(ratio: float) -> str:
    """Return a ratio in words of a table: two digits, and no more zeros than needed.

    Examples
    --------
    >>> times(1234.5), times(12.34), times(0.1234)
    ('1200', '12', '0.12')
    """
    return f"{float(f'{ratio:.2g}'):g}" if ratio < 1e6 else f"{ratio:.1e}"


def duration(seconds: float) -> str:
    r"""Return a time in the unit that suits it, in two or three digits; no line ends between them.

    Examples
    --------
    >>> print(*map(ascii, [duration(1.234), duration(0.0123), duration(7.8e-8)]))
    '1.23\xa0s' '12.3\xa0ms' '78\xa0ns'
    """
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= size:
            return unbroken(f"{float(f'{seconds / size:.3g}'):g} {unit}")
    return unbroken(f"{float(f'{seconds / 1e-9:.3g}'):g} ns")


def unbroken(text: str) -> str:
    r"""Return a text in which no line ends within a number, or between one and its unit.

    Examples
    --------
    >>> print(ascii(unbroken("at most 3 ms, or 5 of 7, to 1e-4")))
    'at most 3\xa0ms, or 5\xa0of 7, to 1e\u20114'
    """
    text = re.sub(r"(?<=\de)-(?=\d)", "\N{NON-BREAKING HYPHEN}", text)
    return re.sub(r"(?<=\d) (?=(?:[mµn]?s|rad|MiB|%|of)(?!\w))", "\N{NO-BREAK SPACE}", text)
