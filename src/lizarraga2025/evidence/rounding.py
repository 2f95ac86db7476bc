"""Errors of printed digits and of doubles, and the effect of printed digits on a contact."""

from dataclasses import replace
from functools import cache
from typing import Any, Final

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.evidence.arms import pairs, robot
from lizarraga2025.printed import HALF_DIGIT
from qbound import Pair, Robot, closest_approach

COMPONENT = float(HALF_DIGIT * (2 + np.sqrt(2)))
"""Largest error of a component, cm: of four rounded offsets, two of them turned by the joint."""

SMALL = 1e-9
"""A length (cm) or angle (rad) that is rounding: offsets carry 1e-2, roundoff leaves 1e-13."""


def degrees(angle: Any) -> str:
    """Write an angle in rad as degrees with four decimals."""
    return f"{np.degrees(float(angle)):.4f}°"


def counted(number: int, noun: str) -> str:
    """Write how many there are of something: one curve, 2 curves."""
    return f"one {noun}" if number == 1 else f"{number} {noun}s"


def contact(pair: Pair, of: Robot | None = None) -> float:
    """Return the largest gap, cm, that rounding of the offsets can leave to points that meet.

    To first order a radius changes by at most the sum of the rounding errors of its components,
    each times its direction cosine. The joint between the points is printed too: its two offsets
    add their own error, as those of a point do.
    """
    of = of or robot()
    near, far = (of.point(name) for name in pair.points)
    first = near.at - next(j.origin for j in of.joints if j.frame == far.frame)
    slopes = (np.abs(v).sum() / np.linalg.norm(v) for v in (first, far.at, first))
    return float(sum(HALF_DIGIT * slope for slope in slopes))


TABLE_4: Final = (("12", "x_{1,12}", "z_{1,12}"), ("13", "x_{2,13}", "z_{2,13}"))
"""Points of Table 4, with the labels of their offsets."""


@cache
def slips_of_table_4() -> dict[str, float]:
    """Return the gaps, cm, of B4 with one digit of Table 4 changed, or two neighbours exchanged.

    Only those that rounding explains, such as "x_{2,13} = 9.09".
    """
    cm, pair = paper.offsets_in_cm(), pairs()[3]
    found = {}
    for point, *labels in TABLE_4:
        for place, label in zip((0, 2), labels, strict=True):
            for text in _one_slip(f"{cm[label]:.2f}"):
                at = robot().point(point).at.copy()
                at[place] = float(text)
                gap = closest_approach(_moved(point, at), pair).gap
                if gap <= contact(pair):
                    found[f"{label} = {text}"] = gap
    return dict(sorted(found.items(), key=lambda item: item[1]))


def _one_slip(number: str) -> list[str]:
    """Return a number with one digit changed, or with two neighbouring digits exchanged."""
    dot, digits = number.index("."), number.replace(".", "")
    texts = {digits[:i] + new + digits[i + 1 :] for i in range(len(digits)) for new in "0123456789"}
    texts |= {
        digits[:i] + digits[i + 1] + digits[i] + digits[i + 2 :] for i in range(len(digits) - 1)
    }
    return [f"{text[:dot]}.{text[dot:]}" for text in sorted(texts - {digits})]


def _moved(name: str, at: np.ndarray) -> Robot:
    points = tuple(replace(p, at=at) if p.name == name else p for p in robot().points)
    return replace(robot(), points=points)


def other_slips() -> str:
    """Tell which other single slips in Table 4 would do as well as x_{2,13} = 9.09."""
    found = {name: gap for name, gap in slips_of_table_4().items() if name != "x_{2,13} = 9.09"}
    listed = ", ".join(f"{name} ({gap:.4f} cm)" for name, gap in found.items())
    return (
        "Within the rounding one changed digit or two exchanged ones also give"
        f" {listed or 'none'}; 9.09 is chosen because it is the number of the opposite corner,"
        " x_{2,11}, whose z_{2,11} is -z_{2,13}."
    )


def at_a_root(slope: np.ndarray, component: int) -> float:
    """Return the largest distance, cm, of points that meet, where one printed component vanishes.

    Each component carries up to four rounded offsets, two of them turned by the joint. The error of
    the vanishing one shifts the root, and the other then changes by the ratio of the slopes.

    Parameters
    ----------
    slope : ndarray, shape (3,)
        Derivative of the pair's vector along the joint, cm.
    component : int
        The component that vanishes.
    """
    return float(
        COMPONENT * (1 + np.linalg.norm(np.delete(slope, component)) / abs(slope[component]))
    )
