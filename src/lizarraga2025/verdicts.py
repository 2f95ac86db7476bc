"""How the outcome of a computation becomes a verdict: nobody types one."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Literal, get_args

Verdict = Literal[
    "confirmed",
    "confirmed with a condition",
    "not determined by the text",
    "misprint",
    "needs correction",
    "vacuous",
    "refuted",
]

VERDICTS: Final[tuple[Verdict, ...]] = get_args(Verdict)
"""The verdicts, the most favourable to the statement first.

A slip of the pen leaves what its author meant, and a correction what its formula is for; a sentence
that says nothing leaves nothing.
"""


@dataclass(frozen=True)
class Outcome:
    """What a computation gives: verdicts, and a sentence with its numbers.

    Attributes
    ----------
    most_favourable : str
        The verdict of that reading, of the fair ones, which is kindest to the statement.
    computed : str
        What was computed; empty where the entry's finding tells it.
    likeliest : str
        The verdict of the reading that a reader of the paper takes first; the other one where
        nothing else is given, as the readings do not differ.
    """

    most_favourable: Verdict
    computed: str = ""
    likeliest: Verdict | None = None

    def __post_init__(self) -> None:
        """Let the verdict of a statement with one reading stand for both."""
        if self.likeliest is None:
            object.__setattr__(self, "likeliest", self.most_favourable)


def judge(
    *,
    holds: bool,
    constrains: bool = True,
    under: bool = False,
    corrected: bool = False,
    amended: bool = False,
) -> Verdict:
    """Turn the outcome of a computation into a verdict.

    Parameters
    ----------
    holds : bool
        Whether the statement held, as printed, wherever it claims to.
    constrains : bool
        Whether anything that it speaks of could violate it (asked where `holds` is true).
    under : bool
        Whether it held everywhere under a condition that was computed (asked where `holds` is
        false: a counterexample lies outside the condition).
    corrected : bool
        Whether it held with one slip of the pen corrected, where the printed one did not.
    amended : bool
        Whether a formula that is wrong as printed held with the correction that its entry states,
        which is more than a slip of the pen: another function, another root.
    """
    if holds:
        return "confirmed" if constrains else "vacuous"
    if under:
        return "confirmed with a condition"
    if corrected:
        return "misprint"
    return "needs correction" if amended else "refuted"


def formula(*, holds: bool, amended: bool, computed: str) -> Outcome:
    """Judge a formula as printed, and, most favourably, with what is often meant by it.

    `amended` tells whether it holds with the correction that its entry states.
    """
    return Outcome(judge(holds=holds, under=amended), computed, judge(holds=holds, amended=amended))


def undetermined(readings: Mapping[str, bool]) -> Verdict:
    """Turn the readings that the text allows, and whether each fits all of it, into a verdict.

    One reading alone fits: confirmed under that reading. Several fit: the text does not decide.
    None fits: refuted.
    """
    fitting = sum(readings.values())
    if fitting > 1:
        return "not determined by the text"
    return judge(holds=False, under=fitting == 1)


def reading(name: str, **outcome: bool) -> tuple[str, Verdict]:
    """Return a reading, by a name that completes "read as ...", with its verdict: see `judge`."""
    return name, judge(**outcome)


def of_readings(computed: str, *readings: tuple[str, Verdict]) -> Outcome:
    """Judge a statement that can fairly be read in several ways, the likeliest first.

    The likeliest is the one that a reader of the paper takes first. Where the readings differ, a
    sentence with each of their verdicts follows what was computed.
    """
    verdicts = [verdict for _, verdict in readings]
    if len(set(verdicts)) > 1:
        each = "; ".join(f"{name}: {verdict}" for name, verdict in readings)
        computed = f"{computed} Read as {each}.".strip()
    return Outcome(min(verdicts, key=VERDICTS.index), computed, verdicts[0])


def of_rows(rows: Iterable[Outcome], more: str = "") -> Outcome:
    """Judge a table as the least favourable of its rows, and tell how many have each verdict."""
    verdicts = [row.most_favourable for row in rows]
    counts = Counter(verdicts)
    words = ", ".join(f"{counts[v]} {v}" for v in VERDICTS if counts[v])
    return Outcome(max(verdicts, key=VERDICTS.index), f"Of {len(verdicts)} rows {words}{more}.")
