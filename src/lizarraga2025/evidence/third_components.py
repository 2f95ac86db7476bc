"""Where the third components of the point pairs are positive together, against the windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lizarraga2025.evidence.arms import pairs
from lizarraga2025.evidence.rounding import degrees, turned_by_rounding
from qbound.boundary.functions import pair_vector
from qbound.forms.circle import circle_arc
from qbound.forms.factors import TURN
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Robot
from qbound.region import paper_rule

Interval = tuple[float, float]


@dataclass(frozen=True)
class Sides:
    """Values of a joint at which the third components of its pairs are positive, rad.

    Attributes
    ----------
    joint : int
        The joint between the points.
    ends, window : tuple of two float
        Ends of the piece that holds home, and of what the windows of Table 6 leave.
    allowed : float
        How far rounding of the offsets can move one against the other.
    rest : float
        Length of the other pieces.
    """

    joint: int
    ends: Interval
    window: Interval
    allowed: float
    rest: float

    @property
    def apart(self) -> float:
        """The larger difference of two ends."""
        return max(abs(x - y) for x, y in zip(self.ends, self.window, strict=True))


def sides(of: Robot) -> list[Sides]:
    """Compare the signs of the third components with the windows, for each joint."""
    return [_of_a_joint(of, joint) for joint in range(len(of.joints))]


def _of_a_joint(of: Robot, joint: int) -> Sides:
    vectors = (pair_vector(of, pair) for pair in pairs(of))
    first, second = (_positive(v[2], of, joint) for v in vectors if v.joints() == (joint,))
    copies = [(second[0] + turn, second[1] + turn) for turn in (-TURN, 0.0, TURN)]
    pieces = [(max(first[0], low), min(first[1], high)) for low, high in copies]
    home = next(piece for piece in pieces if piece[0] < of.home[joint] < piece[1])
    rest = sum(high - low for low, high in pieces if low < high and (low, high) != home)
    box = paper_rule.box(of)
    bounds = (box.lower_bounds[joint], box.upper_bounds[joint])
    allowed = max(_shift(of, joint, q, b) for q, b in zip(home, bounds, strict=True))
    return Sides(joint, home, (float(box.lower[joint]), float(box.upper[joint])), allowed, rest)


def _positive(form: HarmonicForm, of: Robot, joint: int) -> Interval:
    """Return the ends of the arc on which a component is positive, by Theorem 2 restated."""
    c0, a, b = form.along(joint, of.home)
    arc = circle_arc(a, b, -c0)
    return float(arc.centre - arc.half_width), float(arc.centre + arc.half_width)


def _shift(of: Robot, joint: int, q: float, bound: paper_rule.Bound) -> float:
    """Return how far rounding can move the root of a third component from that of a bound."""
    pose = np.array(of.home, dtype=float)
    pose[joint] = q
    pair = next(pair for pair in pairs(of) if pair.name == bound.boundary)
    slope = pair_vector(of, pair).gradient(pose)[:, joint]
    return sum(turned_by_rounding(float(slope[j])) for j in (2, bound.component - 1))


def in_words(of: Robot) -> str:
    """Tell for each joint where the components are positive, and what the windows have."""
    return "; ".join(
        f"q_{one.joint + 1} from {degrees(one.ends[0])} to {degrees(one.ends[1])}, in the windows"
        f" {degrees(one.window[0])} to {degrees(one.window[1])}"
        for one in sides(of)
    )
