"""Contacts of links as others read them: JSON, a table, and the SRDF of motion planners."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any
from xml.etree import ElementTree as ET

from qbound.arms.allowed import Contact, LinkContact
from qbound.export.formats import heading
from qbound.model.robot import Robot
from qbound.printable import printable
from qbound.units import counted, joint_text, joint_units

SHOWN_DIGITS = 4
"""Of lengths in a table."""


def allowed_document(robot: Robot, found: Sequence[LinkContact]) -> dict[str, Any]:
    """Return the JSON form of contacts, schema qbound/allowed/1: rad, the file's unit of length."""
    return {
        **heading("qbound/allowed/1", robot),
        "joints": [joint.name for joint in robot.joints],
        "units": {"joints": joint_units(robot), "length": robot.length_unit},
        "pairs": [_entry(robot, each) for each in found],
    }


def _entry(robot: Robot, found: LinkContact) -> dict[str, Any]:
    witness = found.contact is Contact.SOMETIMES
    return {
        "links": list(found.links),
        "contact": found.contact.value,
        "neighbours": found.neighbours,
        "joints": [robot.joints[j].name for j in found.joints],
        "balls": list(found.balls),
        "nearest": found.nearest.tolist(),
        "gap": found.gap,
        "proved_gap": found.proved_gap,
        "touching": found.nearest.tolist() if witness else None,
        "apart": found.apart.tolist() if witness and found.apart is not None else None,
        "cells": found.cells,
    }


def allowed_lines(robot: Robot, found: Sequence[LinkContact]) -> Iterator[str]:
    """Yield a table of contacts, and their count; of the balls that stand for the links."""
    rows = [(", ".join(map(printable, each.links)), each) for each in found]
    wide = max((len(name) for name, _ in rows), default=0)
    for name, each in rows:
        yield f"{name:{wide}}  {each.contact.value:<11}  {evidence(robot, each)}"
    counts = {word: sum(each.contact is word for each in found) for word in Contact}
    parts = [f"{count} {word.value}" for word, count in counts.items() if count]
    yield f"{counted(len(found), 'pair')} of links: {', '.join(parts)} in contact"


def evidence(robot: Robot, found: LinkContact) -> str:
    """Say in a phrase what a contact rests on."""
    length = f"{abs(found.gap):.{SHOWN_DIGITS}g} {robot.length_unit}"
    if found.contact is Contact.SOMETIMES:
        q = found.nearest[list(found.joints)]
        return f"{length} deep at {joint_text(robot, q, found.joints)}"
    if found.contact is Contact.NEVER and found.proved_gap is not None:
        least = f"{_rounded_down(found.proved_gap):.{SHOWN_DIGITS}g} {robot.length_unit}"
        return f"{least} apart at least (proved); {length} found"
    if found.contact is Contact.ALWAYS:
        return f"proved by {counted(found.cells, 'cell')}"
    touch = "no contact found" if found.gap > 0 else "contact found"
    return f"{touch}; {counted(found.cells, 'cell')} are too few"


def _rounded_down(value: float) -> float:
    """Cut a positive number to the digits that are shown: what is said stays proved."""
    if not value > 0:
        return 0.0
    step = 10.0 ** (math.floor(math.log10(value)) - SHOWN_DIGITS + 1)
    return math.floor(value / step) * step


def srdf_text(robot: Robot, found: Sequence[LinkContact], *, neighbours: bool = False) -> str:
    """Return the pairs of links that a planner need not check, as SRDF.

    Parameters
    ----------
    neighbours : bool
        Whether neighbours that meet sometimes are left out of checking too, as is usual: then the
        fold of an elbow is not seen.

    Notes
    -----
    The reason of neighbours that always touch is "Adjacent". Pairs that are not decided, and others
    that meet sometimes, have no line: they are to be checked.

    Raises
    ------
    ValueError
        If a name has a letter that XML cannot hold.
    """
    root = ET.Element("robot", name=_xml(robot.name))
    for each in found:
        reason = disabling_reason(each, neighbours)
        if reason is not None:
            one, other = map(_xml, each.links)
            ET.SubElement(root, "disable_collisions", link1=one, link2=other, reason=reason)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def disabling_reason(found: LinkContact, neighbours: bool = False) -> str | None:
    """Return why a pair need not be checked, as SRDF says it; None: it must be."""
    if found.contact is Contact.NEVER:
        return "Never"
    if found.contact is Contact.ALWAYS:
        return "Adjacent" if found.neighbours else "Always"
    meets = found.contact is Contact.SOMETIMES
    return "Adjacent" if found.neighbours and neighbours and meets else None


def _xml(name: str) -> str:
    """Refuse what XML 1.0 cannot hold, escaped or not."""
    if any(
        not (x in "\t\n\r" or " " <= x <= "\ud7ff" or "\ue000" <= x <= "\ufffd" or x > "\uffff")
        for x in name
    ):
        raise ValueError(f"{printable(name)}: a name with a letter that XML cannot hold")
    return name
