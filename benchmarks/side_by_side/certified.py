"""What a certificate of a scene is about, and how much of the component at home it holds."""

from __future__ import annotations

import json
from math import radians
from typing import Any

import scenes
from quality import quality

from qbound.model.robotfile import robot_text


def text_of(scene: str) -> str:
    """Return the robot file of a scene: a certificate is about a text.

    Raises
    ------
    KeyError
        If the scene has none.
    """
    return robot_text(scenes.FILES[scene])[0]


def rings_of(certificate: str, degrees: bool) -> list[list[list[list[float]]]]:
    """Return the polygon that a certificate is about, in radians: one component, its loops."""
    loops = json.loads(certificate)["claim"]["points"]
    turn = radians if degrees else float
    return [[[[turn(float(x)) for x in point] for point in loop] for loop in loops]]


def with_share(scene: str) -> Any:
    """Return what puts the share of home's component in the place of the polygons in answers."""
    home = [float(x) for x in scenes.robot(scene).home]

    def compare(answers: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        kept = {}
        for name, answer in answers.items():
            found = quality(scene, answer["rings"], (home[0], home[1]))
            kept[name] = {key: value for key, value in answer.items() if key != "rings"}
            kept[name] |= {"share": found["covered"], "beyond": found["beyond"]}
        return kept

    return compare
