"""How the outcome of a computation becomes a verdict: nobody types one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, get_args

Verdict = Literal[
    "confirmed",
    "confirmed with a condition",
    "true but says nothing",
    "misprint",
    "refuted",
    "not determined by the text",
]

VERDICTS: Final[tuple[Verdict, ...]] = get_args(Verdict)

FAVOUR: Final[tuple[Verdict, ...]] = (
    "confirmed",
    "confirmed with a condition",
    "not determined by the text",
    "misprint",
    "true but says nothing",
    "refuted",
)
"""The verdicts, the most favourable to the statement first.

A slip of the pen leaves what its author meant; a sentence that says nothing leaves nothing.
"""


@dataclass(frozen=True)
class Outcome:
    """What a computation gives: the verdict that follows, and a sentence with its numbers."""

    verdict: Verdict
    found: str


def judge(
    *, holds: bool, constrains: bool = True, under: bool = False, corrected: bool = False
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
    """
    if holds:
        return "confirmed" if constrains else "true but says nothing"
    if under:
        return "confirmed with a condition"
    return "misprint" if corrected else "refuted"


def undetermined(readings: Mapping[str, bool]) -> Verdict:
    """Turn the readings that the text allows, and whether each fits all of it, into a verdict.

    One reading alone fits: confirmed under that reading. Several fit: the text does not decide.
    None fits: refuted.
    """
    fitting = sum(readings.values())
    if fitting > 1:
        return "not determined by the text"
    return judge(holds=False, under=fitting == 1)


def strongest(readings: Mapping[str, Verdict], found: str) -> Outcome:
    """Judge a statement that can fairly be read in several ways: the best reading decides.

    Parameters
    ----------
    readings : mapping
        The verdict of each fair reading, by a name that completes "read as ...".
    found : str
        What was computed; where the readings differ, a sentence with each of their verdicts
        follows it.
    """
    verdict = min(readings.values(), key=FAVOUR.index)
    if len(set(readings.values())) > 1:
        each = "; ".join(f"{name}: {its}" for name, its in readings.items())
        found = f"{found} Read as {each}."
    return Outcome(verdict, found)
