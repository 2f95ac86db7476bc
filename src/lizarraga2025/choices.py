"""The choices that the book makes where the paper's text leaves one, each once and with its reason.

`CHOICES` has them all, with recorded results that tell what each gives and what another choice
gives; the page Replication shows them as a table.
"""

from dataclasses import dataclass
from typing import Final

SCALE: Final = 0.95
"""Of the polygon of Figures 6 to 10; the text states none (F-6.4)."""

RIGHT: Final = (5, 0, 1, 2, 3)
LEFT: Final = (2, 3, 4, 5, 0)
"""The sequences of Figures 8 and 9, points from 0: 6-1-2-3-4 and 3-4-5-6-1 (F-8.1)."""


@dataclass(frozen=True)
class Choice:
    """One choice.

    Attributes
    ----------
    about, chosen, reason, other : str
        What the text leaves open, what the book takes, why, and what it could take.
    compared : str
        What the two choices are compared in; empty where they give the same.
    results : tuple of str
        Recorded results of the choice and of the other one, such as ``region:paper.area``.
    """

    about: str
    chosen: str
    reason: str
    other: str
    compared: str = ""
    results: tuple[str, ...] = ()


CHOICES: Final = (
    Choice(
        "the inverse tangent of eq. (34)",
        "atan2(b, a)",
        "it solves the equation in every quadrant",
        "arctan(b / a)",
        "area around home",
        ("region:paper.area", "region:arctan.area"),
    ),
    Choice(
        "the unit of Table 5",
        "centimetres",
        "Table 4, with the same unit, has no contacts in millimetres",
        "millimetres",
        "area around home",
        ("region:paper.area", "every_region:floor.mm.area"),
    ),
    Choice(
        "the upper side of q2 (Figure 4)",
        "β_{3,3,1}",
        "a window holds home",
        "β_{3,3,2}, the same line a turn lower, which leaves home out",
    ),
    Choice(
        "the digit x_{2,13} of Table 4",
        "9.00, as printed",
        "most conclusions do not hang on it",
        "9.09, with which the points meet",
        "area around home",
        ("region:paper.area", "bodies:mended.area.points"),
    ),
    Choice(
        "how the six points are joined",
        "along the boundary functions",
        "the straight lines leave the region",
        "by straight lines",
        "area enclosed",
        ("region:paper.area", "region:polygon.area"),
    ),
    Choice(
        "the home pose",
        "both joints at zero",
        "Tables 1 and 2 are read off there",
        "any other pose of the region, which gives the same region",
    ),
    Choice(
        "the scale of the polygon",
        f"{SCALE:g}",
        "the tool keeps its limit, with a margin",
        "0.8",
        "largest distance of the two paths of Figure 10, one mirrored",
        ("workspace:asymmetry.minervabot-v2.0.95", "workspace:asymmetry.minervabot-v2.0.8"),
    ),
    Choice(
        "the centre of scaling",
        "the centroid of the area",
        "it does not change when points on the boundary are added",
        "the mean of the six points",
        "largest scale that keeps the limits",
        ("region:largest_scale.area", "region:largest_scale.vertices"),
    ),
    Choice(
        "the least distance of eq. (11)",
        "0.1 cm",
        "with the printed offsets every pair comes closer than that",
        "0.001 cm, which no pair comes closer than",
        "area around home",
        ("every_region:clearance.area", "every_region:clearance.0.001.home"),
    ),
    Choice(
        "the bodies of the links",
        "rectangles through the printed points",
        "the points are their corners, within the rounding",
        "the points alone",
        "area around home",
        ("bodies:printed.area.bodies", "bodies:paper.area"),
    ),
    Choice(
        "the five points of Figures 8 and 9",
        "6-1-2-3-4 and 3-4-5-6-1",
        "mirroring the arm turns each into the other, and neither crosses itself",
        "others of the orders that do not cross themselves",
    ),
)
