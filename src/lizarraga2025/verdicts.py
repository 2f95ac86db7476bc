"""How the outcome of a computation becomes a verdict: nobody types one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, get_args

Verdict = Literal[
    "confirmed",
    "confirmed with a condition",
    "misprint",
    "refuted",
    "not determined by the paper",
]

VERDICTS: Final[tuple[Verdict, ...]] = get_args(Verdict)


@dataclass(frozen=True)
class Finding:
    """What a computation gives: the verdict that follows, and a sentence with its numbers."""

    verdict: Verdict
    found: str


def judge(*, holds: bool, under: bool = False, corrected: bool = False) -> Verdict:
    """Turn the outcome of a computation into a verdict.

    Parameters
    ----------
    holds : bool
        Whether the statement held, as printed, wherever it claims to.
    under : bool
        Whether it held everywhere under a condition that was computed (asked where `holds` is
        false: a counterexample lies outside the condition).
    corrected : bool
        Whether a corrected statement held where the printed one did not: a slip of the pen.
    """
    if holds:
        return "confirmed"
    if under:
        return "confirmed with a condition"
    return "misprint" if corrected else "refuted"


def undetermined(readings: Mapping[str, bool]) -> Verdict:
    """Turn the readings that the print allows, and whether each fits all of it, into a verdict.

    One reading alone fits: confirmed under that reading. Several fit: the print does not decide.
    None fits: refuted.
    """
    fitting = sum(readings.values())
    if fitting > 1:
        return "not determined by the paper"
    return judge(holds=False, under=fitting == 1)


def require(outcome: bool, statement: str) -> None:
    """Stop where a corrected statement is not proved: it may not stand in the ledger.

    Raises
    ------
    ArithmeticError
        If the outcome is false.
    """
    if not outcome:
        raise ArithmeticError(f"not proved: {statement}")
