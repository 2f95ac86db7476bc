"""Our own certificates of home's component: proved, and checked by each of the two checkers."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from typing import Any

from certified import rings_of, text_of
from serve import Refused, Timed, serve, timed

from qbound.model.robotfile import parse_robot
from qbound.proofs.certificates.certify import Certificate, certify_region
from qbound.proofs.certificates.statements import usual_inset


@lru_cache(maxsize=4)
def inset(scene: str) -> float:
    """Return the strip along the arcs that `qbound certify --region` leaves out."""
    return usual_inset(parse_robot(tomllib.loads(text_of(scene))))


@lru_cache(maxsize=4)
def certificate(scene: str) -> Certificate:
    """Return the certificate of home's component."""
    return certify_region(text_of(scene), inset(scene))


def certify(scene: str, iterations: int = 0) -> Timed:
    """Search for the proof, write it down, and have it confirmed by `check.py` as always."""
    text, strip = text_of(scene), inset(scene)
    wall, processor, found = timed(lambda: certify_region(text, strip))
    return wall, processor, described(scene, found)


def check(scene: str) -> Timed:
    """Check by the checker that takes balls of Arb."""
    from qbound.proofs import second

    found = certificate(scene)
    wall, processor, _ = timed(lambda: second.verify(found.text))
    return wall, processor, described(scene, found)


def alone(scene: str) -> Timed:
    """Check by `check.py`, which needs Python alone."""
    from qbound import check as checker

    found = certificate(scene)
    wall, processor, _ = timed(lambda: checker.check(found.text))
    return wall, processor, described(scene, found)


def described(scene: str, found: Certificate) -> dict[str, Any]:
    """Return the polygon, and how large the proof is."""
    if not found.text:
        raise Refused(found.said)
    degrees = tomllib.loads(text_of(scene))["angle_unit"] == "deg"
    return {
        "rings": rings_of(found.text, degrees),
        "cells": found.leaves,
        "bytes": len(found.text),
        "inset": inset(scene),
    }


if __name__ == "__main__":
    needs = {"numpy": "numpy", "flint": "python-flint"}
    serve("qbound, certificate", needs, {"certify": certify, "check": check, "alone": alone})
