"""Worlds in which an entry of the ledger turns: what it is computed from, altered.

An altered printed value or robot is a world that could be; an altered function is the last resort,
and then the thing that is judged (for an identity: one sign changed).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import replace
from pkgutil import resolve_name
from types import ModuleType
from typing import Any
from unittest.mock import patch

import numpy as np

from cspace import load_robot
from cspace.model.robot import Robot
from lizarraga2025 import printed as paper
from lizarraga2025.beyond import evidence as beyond
from lizarraga2025.computations import registry
from lizarraga2025.evidence import arms

World = Callable[[], AbstractContextManager[None]]


def world(
    *,
    printed: Mapping[str, Any] | None = None,
    robots: Mapping[str, Robot] | None = None,
    replaced: Mapping[str, Any] | None = None,
) -> World:
    """Return a world, to be entered with ``with``; made when called, not when described.

    Parameters
    ----------
    printed : mapping, optional
        New values of attributes of `lizarraga2025.printed`, by name. A mapping given for a mapping
        alters the keys it names and keeps the others.
    robots : mapping, optional
        What `evidence.arms` and `beyond.evidence` load, by the name they ask for.
    replaced : mapping, optional
        New values by dotted name, such as ``lizarraga2025.evidence.proofs.general`` or
        ``qbound.frames.Frames.position``; seen by every module that imported the old one.
    """

    @contextmanager
    def altered() -> Iterator[None]:
        registry.by_id()  # entries are registered by what our world prints
        changes = [(paper, name, _merged(name, value)) for name, value in (printed or {}).items()]
        if robots:
            changes += [
                (module, "load_robot", lambda name: robots.get(name) or load_robot(name))
                for module in (arms, beyond)
            ]
        for name, value in (replaced or {}).items():
            changes += [(*place, value) for place in _places(name)]
        forget()
        try:
            with ExitStack() as stack:
                for owner, name, value in changes:
                    stack.enter_context(patch.object(owner, name, value))
                yield
        finally:
            forget()

    return altered


def forget() -> None:
    """Empty every cache of the companion."""
    for module in _modules("lizarraga2025"):
        for value in list(vars(module).values()):
            if callable(clear := getattr(value, "cache_clear", None)):
                clear()


def robot_file(name: str = "minervabot-v2") -> Robot:
    """Return a packaged robot, in this world."""
    return load_robot(name)


def with_points(of: Robot, **places: Iterable[float]) -> Robot:
    """Return a robot with some points elsewhere in their frames: ``p13=(9.09, 0, 5.25)``."""
    moved = {name.removeprefix("p"): np.array(at, dtype=float) for name, at in places.items()}
    assert moved.keys() <= {point.name for point in of.points}
    return replace(of, points=tuple(replace(p, at=moved.get(p.name, p.at)) for p in of.points))


def with_boundaries(of: Robot, **changes: Mapping[str, Any]) -> Robot:
    """Return a robot with some boundaries changed: ``B7={"offset": 0.0}``."""
    assert changes.keys() <= {boundary.name for boundary in of.boundaries}
    changed = tuple(replace(b, **changes.get(b.name, {})) for b in of.boundaries)
    return replace(of, boundaries=changed)


def with_joints(of: Robot, **changes: Mapping[str, Any]) -> Robot:
    """Return a robot with some joints changed: ``q1={"limits": (-1.0, 1.0)}``."""
    assert changes.keys() <= {joint.name for joint in of.joints}
    joints = tuple(replace(joint, **changes.get(joint.name, {})) for joint in of.joints)
    return replace(of, joints=joints)


def _merged(name: str, value: Any) -> Any:
    old = getattr(paper, name)
    return {**old, **value} if isinstance(old, Mapping) else value


def _places(dotted: str) -> Iterator[tuple[Any, str]]:
    """Yield the class that has an attribute, or every module of the project that holds a value."""
    owner, _, attribute = dotted.rpartition(".")
    if isinstance(resolve_name(owner), type):
        yield resolve_name(owner), attribute
        return
    value = resolve_name(dotted)
    for module in (*_modules("lizarraga2025"), *_modules("cspace"), *_modules("qbound")):
        yield from ((module, name) for name, held in vars(module).items() if held is value)


def _modules(package: str) -> list[ModuleType]:
    return [
        module
        for name, module in sys.modules.items()
        if module and (name == package or name.startswith(f"{package}."))
    ]
