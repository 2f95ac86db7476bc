"""An SRDF as data: pairs of links that are not checked, and named poses."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from qbound.model.robotcheck import RobotFileError
from qbound.urdf.xml import Element, Source, called, read_xml

HOMES = ("home", "ready")
"""States that are taken for the home pose where nothing else is asked for, in this order."""

OWN = (
    "group", "group_state", "disable_collisions", "disable_default_collisions", "enable_collisions",
    "virtual_joint", "end_effector", "passive_joint",
)  # fmt: skip
"""Elements of which an SRDF has some; a URDF has none of them."""


@dataclass(frozen=True)
class Srdf:
    """An SRDF, read.

    Attributes
    ----------
    disabled : frozenset of frozenset of str
        Pairs of links.
    silent : frozenset of str
        Links that are checked only where a pair is enabled.
    enabled : frozenset of frozenset of str
    states : dict of str to dict of str to float
        Joint values of each named state, rad or m.
    source : Source, optional
    """

    disabled: frozenset[frozenset[str]] = frozenset()
    silent: frozenset[str] = frozenset()
    enabled: frozenset[frozenset[str]] = frozenset()
    states: dict[str, dict[str, float]] | None = None
    source: Source | None = None

    @property
    def named(self) -> frozenset[str]:
        """Links of all its pairs."""
        return self.silent.union(*self.disabled, *self.enabled)

    def checks(self, one: str, other: str) -> bool:
        """Tell whether a pair of links is to be kept apart."""
        pair = frozenset((one, other))
        if pair in self.enabled:
            return True
        return pair not in self.disabled and not pair & self.silent

    def home(self, wanted: str | None) -> dict[str, float]:
        """Return the joint values of a state, by default of one that is called home; or none."""
        states = self.states or {}
        if wanted is not None and wanted not in states:
            known = ", ".join(states) or "none"
            raise ValueError(f"no state {wanted!r}; there are {known}")
        names = HOMES if wanted is None else (wanted,)
        return next((states[name] for name in names if name in states), {})


def read_srdf(path: Path) -> Srdf:
    """Read an SRDF.

    Raises
    ------
    qbound.model.robotcheck.RobotFileError
        With the first fault and its line.
    """
    root, source = read_xml(path, "robot")
    if not any(root.children(tag) for tag in OWN):
        raise RobotFileError(
            f"{called(path)}: no group, no state, no pair of links left out; is it an SRDF?"
        )
    states: dict[str, dict[str, float]] = {}
    for state in root.children("group_state"):
        values = states.setdefault(state.text("name"), {})
        for joint in state.children("joint"):
            if len(joint.text("value").split()) == 1:  # joints of more freedom have more
                values[joint.text("name")] = joint.number("value")
    return Srdf(
        disabled=_pairs(root, "disable_collisions"),
        silent=frozenset(each.text("link") for each in root.children("disable_default_collisions")),
        enabled=_pairs(root, "enable_collisions"),
        states=states,
        source=source,
    )


def _pairs(root: Element, tag: str) -> frozenset[frozenset[str]]:
    found = root.children(tag)
    return frozenset(frozenset((each.text("link1"), each.text("link2"))) for each in found)
