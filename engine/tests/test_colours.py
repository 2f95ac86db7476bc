"""The palette: its meanings stay apart for colour-blind readers, in grey, and on paper."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from cspace import figures
from cspace.figures import workspace as figures_workspace

# The identity, and deuteranopes and protanopes by Viénot, Brettel and Mollon (1999): matrices on
# linear RGB.
EYES = {
    "every eye": np.eye(3),
    "deuteranopia": [[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]],
    "protanopia": [[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]],
}
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], LUMINANCE, [0.0193, 0.1192, 0.9505]])

MEANINGS = {
    "feasible and colliding": (figures.FEASIBLE, figures.COLLIDING),
    "used and unused": (figures.USED, figures.UNUSED),
    "two signs of det J": tuple(figures_workspace.SIDES.values()),
    "one posture and two": (figures_workspace.ONCE, figures_workspace.TWICE),
}
ON_PAPER = ("used and unused", "one posture and two")
"""Told apart by lightness too; feasible and colliding by marker, the two signs by name."""

NAMES = ("FEASIBLE", "COLLIDING", "USED", "UNUSED", "SECOND", "OVERLAP", "INK")
LINES = {name: getattr(figures, name) for name in NAMES}
LINES |= {f"B{k}": colour for k, colour in enumerate(figures.BOUNDARIES, start=1)}


def linear(colour: str) -> np.ndarray:
    """Linear RGB of #RRGGBB, by the sRGB standard."""
    s = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIELAB of linear RGB: two units are about what an eye can just tell apart side by side."""
    t = TO_XYZ @ np.clip(rgb, 0, 1) / TO_XYZ.sum(axis=1)
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def apart(one: str, other: str, eye: object) -> float:
    see = np.asarray(eye)
    return float(np.linalg.norm(lab(see @ linear(one)) - lab(see @ linear(other))))


def contrast(one: str, other: str) -> float:
    """Contrast ratio of the accessibility guidelines, 1 to 21."""
    low, high = sorted(float(LUMINANCE @ linear(c)) for c in (one, other))
    return (high + 0.05) / (low + 0.05)


def test_contrast_and_distance_are_those_of_the_standards() -> None:
    assert contrast("#000000", "#FFFFFF") == pytest.approx(21)
    assert contrast("#777777", "#FFFFFF") == pytest.approx(4.48, abs=0.01)
    assert lab(linear("#FF0000")) == pytest.approx([53.24, 80.09, 67.20], abs=0.05)
    for eye in EYES.values():  # grey stays grey for everyone
        assert np.asarray(eye) @ np.ones(3) == pytest.approx(np.ones(3), abs=1e-4)


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("meaning", MEANINGS)
def test_two_meanings_of_one_figure_differ_for_every_eye(meaning: str, eye: str) -> None:
    assert apart(*MEANINGS[meaning], EYES[eye]) > 15


def test_red_and_green_of_one_lightness_would_not_pass() -> None:
    assert apart("#C05050", "#5A8A3A", EYES["deuteranopia"]) < 15


@pytest.mark.parametrize("meaning", ON_PAPER)
def test_in_grey_they_differ_in_lightness(meaning: str) -> None:
    one, other = (lab(linear(colour))[0] for colour in MEANINGS[meaning])
    assert abs(one - other) > 15


@pytest.mark.parametrize("name", LINES)
def test_a_line_stands_out_from_white(name: str) -> None:
    assert contrast(LINES[name], "#FFFFFF") >= 3  # what the guidelines ask of graphics


def test_boundaries_that_bound_one_region_differ_for_every_eye() -> None:
    used = [colour for k, colour in enumerate(figures.BOUNDARIES, start=1) if k not in (5, 6)]
    least = min(apart(*two, eye) for two in combinations(used, 2) for eye in EYES.values())
    assert least > 10


@pytest.mark.parametrize("name", LINES)
def test_nothing_but_a_collision_is_orange(name: str) -> None:
    _, red, yellow = lab(linear(LINES[name]))
    hue, strength = np.degrees(np.arctan2(yellow, red)), np.hypot(red, yellow)
    assert (45 <= hue <= 75 and strength > 60) == (name == "COLLIDING")


@pytest.mark.parametrize("eye", EYES)
def test_the_tints_of_the_workspace_are_light_enough_for_ink(eye: str) -> None:
    for tint in (figures_workspace.ONCE, figures_workspace.TWICE):
        assert apart(tint, figures.INK, EYES[eye]) > 40
        assert contrast(tint, figures.INK) > 7
