"""Who proves something about a region: pavings by cells, and certificates of home's component."""

from __future__ import annotations

import cmath
import json
import tomllib
from functools import lru_cache
from math import prod, radians
from typing import Any

import scenes
from asking import Timed, timed

from cspace import check
from cspace.boundary.functions import clearance
from cspace.model.robotfile import parse_robot, robot_text
from cspace.proofs.certificates.certify import Certificate, certify_region
from cspace.proofs.certificates.statements import usual_inset
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.subpaving.paving import pave


@lru_cache(maxsize=8)
def problem(scene: str) -> Any:
    return exact_problem(exact_robot(scenes.robot(scene)))


def qbound_cells(task: str, scene: str, undecided: float, eps: float) -> Timed:
    """Halve cells until at most a part of the box is undecided; the size of boxes is not used."""
    forms = problem(scene)
    seconds, processor, found = timed(lambda: pave(forms, undecided))
    answer = {"undecided": float(found.undecided_fraction), "inner": float(found.inner_fraction)}
    return seconds, processor, answer | {"boxes": found.cells}


@lru_cache(maxsize=8)
def separator(scene: str) -> Any:
    """Return Codac's separator of a region, one a boundary, and their intersection.

    The other documented way, one separator of the vector of all, takes longer, and finds nothing
    where some boundary depends on one joint alone. Each boundary function is a sum of waves: each
    joint stands in it as rarely as can be, and Codac's bounds are far narrower than of coordinates
    that are squared and added.
    """
    from codac import AnalyticFunction, Interval, SepInverse, VectorVar, cos, oo

    arm, region = scenes.robot(scene), None
    variable = VectorVar(len(arm.joints))
    for boundary in arm.used:
        waves, total, constant = clearance(arm, boundary).waves, None, 0.0
        for amplitude, turns in zip(waves.amplitudes.tolist(), waves.turns.tolist(), strict=True):
            size, angle = cmath.polar(amplitude)
            if not any(turns):
                constant += complex(amplitude).real
                continue
            for j, turn in enumerate(turns):
                if turn:
                    angle = (variable[j] if turn > 0 else -variable[j]) + angle
            wave = size * cos(angle)
            total = wave if total is None else total + wave
        function = AnalyticFunction([variable], total)
        found = SepInverse(function, Interval(-constant, oo))
        region = found if region is None else region & found
    return region


def codac_paving(task: str, scene: str, undecided: float, eps: float) -> Timed:
    """Pave by boxes of one size, as Codac's documentation's example of SIVIA has it.

    Importing codac changes the rounding of this process: nothing else is computed in it.
    """
    from codac import IntervalVector, PavingInOut
    from codac import pave as sivia

    region = separator(scene)
    box = IntervalVector([list(pair) for pair in scenes.ends(scenes.robot(scene)).T.tolist()])
    seconds, processor, found = timed(lambda: sivia(box, region, eps))
    parts = {"undecided": found.boxes(PavingInOut.bound), "inner": found.boxes(PavingInOut.inner)}
    answer = {name: sum(map(volume, some)) / volume(box) for name, some in parts.items()}
    return seconds, processor, answer | {"boxes": sum(map(len, parts.values()))}


def volume(box: Any) -> float:
    return float(prod(box[i].diam() for i in range(box.size())))


def text_of(scene: str) -> str:
    """Return the robot file of a scene: a certificate is about a text."""
    return robot_text(scenes.FILES[scene])[0]


@lru_cache(maxsize=4)
def proved(scene: str) -> Certificate:
    """Prove home's component, but for the strip that `cspace certify --region` leaves out."""
    text = text_of(scene)
    return certify_region(text, usual_inset(parse_robot(tomllib.loads(text))))


def qbound_certificate(task: str, scene: str, iterations: int = 0) -> Timed:
    """Prove and write down ("certify"), or have `check.py` check what was written ("alone")."""
    import shapely

    found = proved(scene)
    if not found.text:
        raise ValueError(found.said)
    seconds, processor, _ = timed(
        (lambda: proved.__wrapped__(scene))
        if task == "certify"
        else (lambda: check.check(found.text))
    )
    loop = json.loads(found.text)["claim"]["points"][0]
    turn = radians if tomllib.loads(text_of(scene))["angle_unit"] == "deg" else float
    shape = shapely.Polygon([[turn(float(x)) for x in point] for point in loop])
    answer = {"shape": shape, "at": scenes.robot(scene).home.tolist(), "cells": found.leaves}
    return seconds, processor, answer | {"bytes": len(found.text)}
