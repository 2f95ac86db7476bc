"""The goals that were set before anything was measured: met, missed or open.

A goal is in the file, with the ids of its measurements: ``of`` names ours and the peer's. The ratio
is theirs over ours; without a peer our quantity counts alone. ``reach`` says how near to the true
boundary (rad) a peer must come to count.
"""

from __future__ import annotations

from collections.abc import Mapping
from statistics import median
from typing import Any

Goal = dict[str, Any]
Measurement = Mapping[str, Any]
SAID = ("id", "part", "text", "sense", "goal", "of", "quantity", "reach")
"""What a goal asks; all else in it is a verdict."""


def judged(goal: Goal, measurements: Mapping[str, Measurement]) -> Goal:
    """Return a goal with its verdict; as it is where not all that it names was measured."""
    if not all(name in measurements for name in goal["of"] if name):
        return goal
    ours, theirs = (measurements[name] if name else None for name in goal["of"])
    told = {name: goal[name] for name in SAID if name in goal}
    told |= {"ours": None, "theirs": None, "ratio": None, "met": None}
    if (why := silent(ours)) is not None:
        return told | {"why": why}
    told["ours"] = mine = value(ours, goal["quantity"])
    if theirs is None:
        return told | {"met": holds(goal, mine)}
    if "over" in theirs and goal["quantity"] == "seconds":  # the ratio is at least this
        least = theirs["over"] / mine
        met = True if goal["sense"] == "at least" and least >= goal["goal"] else None
        why = f"the peer was stopped after {theirs['over']:g} s"
        return told | {"theirs": theirs["over"], "ratio": least, "met": met, "why": why}
    if (why := silent(theirs)) is not None:
        return told | {"why": why}
    if "reach" in goal and (far := theirs["answer"]["all"]["distance"]) > goal["reach"]:
        why = f"{theirs['peer']}: it comes within {far:.2g} rad, not {goal['reach']:g}"
        return told | {"why": why}
    ratio = value(theirs, goal["quantity"]) / mine
    rounds = [each.get("rounds", []) for each in (theirs, ours)]
    if goal["quantity"] == "seconds" and len(rounds[0]) == len(rounds[1]) > 0:
        ratio = median(a / b for a, b in zip(*rounds, strict=True))
    told["theirs"] = value(theirs, goal["quantity"])
    return told | {"ratio": ratio, "met": holds(goal, ratio)}


def silent(measurement: Measurement | None) -> str | None:
    """Return why a measurement says nothing, or None where it has a number."""
    words = (word for word in ("missing", "refused", "over") if word in measurement)
    return next((f"{measurement['peer']}: {word} ({measurement[word]})" for word in words), None)


def value(measurement: Measurement, quantity: str) -> float:
    """Return a quantity of a measurement, such as "seconds" or "answer.share"."""
    for name in quantity.split("."):
        measurement = measurement[name]
    return float(measurement)


def holds(goal: Goal, number: float) -> bool:
    return number >= goal["goal"] if goal["sense"] == "at least" else number <= goal["goal"]
