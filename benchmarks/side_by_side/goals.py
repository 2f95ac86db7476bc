"""The goals, as data: what was measured is put beside them, and each is met, missed or open.

A goal is a number that a quantity, or the ratio of two, must reach. Ids are those of measurements
(`jobs.Job.id_of`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Literal

Measurement = Mapping[str, Any]
Sense = Literal["at least", "at most"]
GROWTH = 11.15
"""(300 / 100)^2 log 300 / log 100."""


@dataclass(frozen=True)
class Goal:
    """One number to reach.

    Attributes
    ----------
    id, part, text : str
        Part is "streams", "regions", "certified" or "start-up"; the text is a sentence without a
        verdict.
    ours : str
        Id of our measurement.
    theirs : str or None
        Id of the peer's. The ratio is theirs over ours; without a peer our quantity alone.
    sense : str
        Whether the goal bounds the ratio from below or from above.
    goal : float
    quantity : str
        "seconds", "processor", or what of the answers, such as "answer.share".
    reach : float or None
        The peer counts only if its boundary is so near to the true one (rad).
    """

    id: str
    part: str
    text: str
    ours: str
    theirs: str | None
    sense: Sense
    goal: float
    quantity: str = "seconds"
    reach: float | None = None


def at_least(id: str, text: str, ours: str, theirs: str, goal: float, part: str) -> Goal:  # noqa: A002
    """Return the goal of being so many times as fast as a peer."""
    return Goal(id, part, text, ours, theirs, "at least", goal)


PAPER_10M = "stream-paper-10m-"
PAPER_100K = "stream-paper-100k-"

GOALS = (
    at_least(
        "streams-numpy-pinocchio",
        "10⁷ random configurations of the paper's robot, in NumPy: 8 times as fast as pinocchio "
        "with coal, one thread each.",
        PAPER_10M + "qbound-numpy",
        PAPER_10M + "pinocchio-coal",
        8,
        "streams",
    ),
    at_least(
        "streams-numpy-fcl",
        "10⁵ random configurations of the paper's robot, in NumPy: 100 times as fast as "
        "python-fcl.",
        PAPER_100K + "qbound-numpy",
        PAPER_100K + "python-fcl",
        100,
        "streams",
    ),
    at_least(
        "streams-compiled-pinocchio",
        "10⁷ random configurations of the paper's robot, compiled: 100 times as fast as pinocchio "
        "with coal, one thread each.",
        PAPER_10M + "qbound-compiled",
        PAPER_10M + "pinocchio-coal",
        100,
        "streams",
    ),
    at_least(
        "streams-compiled-limit",
        "10⁷ random configurations of the paper's robot, compiled, on two threads: half as fast "
        "as both cores can take sines and cosines of both joints from memory.",
        PAPER_10M + "qbound-compiled-two",
        "limit-machine-both-2-limits",
        0.5,
        "streams",
    ),
    Goal(
        "one-numpy-pinocchio",
        "streams",
        "One configuration a call, in NumPy: at most 5 times the time of pinocchio with coal.",
        "one-paper-qbound-numpy",
        "one-paper-pinocchio-coal",
        "at least",
        1 / 5,
    ),
    at_least(
        "one-compiled-pinocchio",
        "One configuration a call, compiled: faster than pinocchio with coal.",
        "one-paper-qbound-compiled",
        "one-paper-pinocchio-coal",
        1,
        "streams",
    ),
    Goal(
        "region-warm",
        "regions",
        "The region of the paper's robot, exact and complete, in a warm process: at most 3 ms.",
        "region-paper-1e-03-qbound-arcs",
        None,
        "at most",
        0.003,
    ),
    Goal(
        "region-from-file",
        "regions",
        "The region of the paper's robot, from its file: at most 4 ms.",
        "region-paper-1e-03-qbound-file",
        None,
        "at most",
        0.004,
    ),
    at_least(
        "region-rays",
        "The region of the paper's robot: faster than ray bisection to 1e-3 rad.",
        "region-paper-1e-03-qbound-arcs",
        "region-paper-1e-03-rays",
        1,
        "regions",
    ),
    Goal(
        "region-alpha",
        "regions",
        "The region of the paper's robot: 10⁴ times as fast as sampling with an alpha shape that "
        "comes within 1e-2 rad.",
        "region-paper-1e-02-qbound-arcs",
        "region-paper-1e-02-alpha-shape",
        "at least",
        1e4,
        reach=1e-2,
    ),
    Goal(
        "region-300",
        "regions",
        "The region of 300 boundaries: at most 1 s.",
        "growth-boundaries-300-qbound-arcs",
        None,
        "at most",
        1.0,
    ),
    Goal(
        "region-growth",
        "regions",
        "From 100 to 300 boundaries the time grows no faster than k² log k.",
        "growth-boundaries-100-qbound-arcs",
        "growth-boundaries-300-qbound-arcs",
        "at most",
        GROWTH,
    ),
    at_least(
        "certificate-check",
        "A certificate is checked faster than Drake's C-IRIS proves one.",
        "check-walls-qbound-certificate",
        "certify-walls-drake-ciris",
        1,
        "certified",
    ),
    Goal(
        "certificate-share",
        "certified",
        "The certificate holds on a larger part of the region than that of Drake's C-IRIS.",
        "check-walls-qbound-certificate",
        "certify-walls-drake-ciris",
        "at most",
        1,
        "answer.share",
    ),
    Goal(
        "start-contains",
        "start-up",
        "`qbound contains` from the shell: at most 150 ms of processor time.",
        "command-contains-startup",
        None,
        "at most",
        0.15,
        "processor",
    ),
)


def judged(
    measurements: Sequence[Measurement], goals: Sequence[Goal] = GOALS
) -> list[dict[str, Any]]:
    """Return every goal with what was measured: `met` is true, false, or null with a `why`."""
    found = {each["id"]: each for each in measurements}
    return [_judged(goal, found) for goal in goals]


def _judged(goal: Goal, found: Mapping[str, Measurement]) -> dict[str, Any]:
    told = {name: getattr(goal, name) for name in ("id", "part", "text", "sense", "goal")}
    told |= {"of": [goal.ours, goal.theirs], "quantity": goal.quantity}
    nothing = {"ours": None, "theirs": None, "ratio": None, "met": None}
    ours = found.get(goal.ours)
    theirs = found.get(goal.theirs) if goal.theirs else None
    if (why := _open(goal.ours, ours)) is not None:
        return told | nothing | {"why": why}
    assert ours is not None
    mine = _value(ours, goal.quantity)
    if goal.theirs is None:
        return told | nothing | {"ours": mine, "met": _holds(goal, mine)}
    if theirs is not None and "over" in theirs:
        return told | nothing | {"ours": mine} | _against_stopped(goal, mine, theirs["over"])
    if (why := _open(goal.theirs, theirs)) is not None:
        return told | nothing | {"ours": mine, "why": why}
    assert theirs is not None
    if goal.reach is not None and (far := _distance(theirs)) > goal.reach:
        why = f"{theirs['peer']}: it comes within {far:.2g} rad, not {goal.reach:g}"
        return told | nothing | {"ours": mine, "why": why}
    ratio = _ratio(ours, theirs, goal.quantity)
    both = {"ours": mine, "theirs": _value(theirs, goal.quantity), "ratio": ratio}
    return told | both | {"met": _holds(goal, ratio)}


def _open(id: str, measurement: Measurement | None) -> str | None:  # noqa: A002
    """Return why a measurement says nothing, or None where it has a number."""
    if measurement is None:
        return f"not measured: {id}"
    for word in ("missing", "refused", "over"):
        if word in measurement:
            return f"{measurement['peer']}: {word} ({measurement[word]})"
    return None


def _against_stopped(goal: Goal, mine: float, limit: float) -> dict[str, Any]:
    """Judge against a peer that was stopped: its time, and with it the ratio, is at least so."""
    least = limit / mine
    settled = goal.quantity == "seconds" and goal.sense == "at least" and least >= goal.goal
    why = f"the peer was stopped after {limit:g} s"
    ratio = {"ratio": least, "theirs": limit} if goal.quantity == "seconds" else {}
    return ratio | {"met": True if settled else None, "why": why}


def _value(measurement: Measurement, quantity: str) -> float:
    value: Any = measurement
    for name in quantity.split("."):
        value = value[name]
    return float(value)


def _distance(measurement: Measurement) -> float:
    """Return how far a peer's boundary is from the true one; infinite where it has none."""
    far = measurement["answer"]["all"]["distance"]
    return float("inf") if far is None else float(far)


def _ratio(ours: Measurement, theirs: Measurement, quantity: str) -> float:
    """Return theirs over ours: of times the median of the rounds' ratios, taken in one run."""
    rounds = [each.get("rounds", []) for each in (theirs, ours)]
    if quantity == "seconds" and len(rounds[0]) == len(rounds[1]) > 0:
        return median(a / b for a, b in zip(*rounds, strict=True))
    return _value(theirs, quantity) / _value(ours, quantity)


def _holds(goal: Goal, value: float) -> bool:
    return value >= goal.goal if goal.sense == "at least" else value <= goal.goal
