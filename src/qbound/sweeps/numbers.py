"""How is a number of a robot named? By its place in the robot file, and in the file's unit.

``joint.elbow.origin.0`` is the first number of ``origin`` in the table [[joint]] whose name is
elbow; ``boundary.B1.clearance``, ``body.upper arm.capsule.to.0``, ``home.q1`` and ``clearance`` are
numbers too. Tables of a list go by their names, numbers of a list by their index.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from qbound.model.schema import JsonPath, one_line
from qbound.model.shapes import default_names
from qbound.printable import printable

Table = Mapping[str, Any]

HIDDEN = "schema"
"""The one number of a robot file that is no number of the robot."""


def find_number(table: Table, name: str) -> JsonPath:
    """Return the place of a number of a robot file by its name; not in the paper.

    Parameters
    ----------
    table : dict
        Content of a robot file.
    name : str
        Keys, names of tables and indices from 0, with dots between them. Names may hold dots.

    Raises
    ------
    ValueError
        If the file has no such number; it says how far the name leads, and what there is.

    Examples
    --------
    >>> table = {"joint": [{"name": "elbow", "origin": [0.4, 0.0, 0.0]}]}
    >>> find_number(table, "joint.elbow.origin.0")
    ('joint', 0, 'origin', 0)
    >>> find_number(table, "joint.elbow.length")
    Traceback (most recent call last):
    ValueError: no 'length' in joint.elbow; there are name, origin
    """
    node: Any = table
    path: list[str | int] = []
    rest = name
    while rest:
        steps = dict(_steps(table, path, node))
        fitting = [word for word in steps if rest == word or rest.startswith(f"{word}.")]
        if not fitting:
            raise ValueError(_no_such(name, rest, list(steps)))
        word = max(fitting, key=len)
        path.append(steps[word])
        node, rest = node[steps[word]], rest[len(word) + 1 :]
    if not isinstance(node, int | float) or isinstance(node, bool):
        inner = ", ".join(one_line(f"{name}.{word}") for word, _ in _steps(table, path, node))
        raise ValueError(f"{one_line(name)} is no number" + (f"; there are {inner}" * bool(inner)))
    return tuple(path)


def with_number(table: Table, path: JsonPath, value: float) -> dict[str, Any]:
    """Return a robot file's content with another value at a place; the given one stays as it is.

    Examples
    --------
    >>> with_number({"point": [{"name": "tip", "at": [0.3, 0.0, 0.0]}]}, ("point", 0, "at", 0), 0.5)
    {'point': [{'name': 'tip', 'at': [0.5, 0.0, 0.0]}]}
    """
    changed = copy.deepcopy(dict(table))
    node: Any = changed
    for step in path[:-1]:
        node = node[step]
    node[path[-1]] = value
    return changed


def _steps(table: Table, path: Sequence[str | int], node: Any) -> Iterator[tuple[str, str | int]]:
    """Yield how one may go on from a place, in words, and the key or index that each means."""
    if isinstance(node, Mapping):
        yield from ((key, key) for key in node if path or key != HIDDEN)
    elif isinstance(node, list) and node and isinstance(node[0], Mapping):
        defaults = _default_names(table).get(path[0] if path else "", [])
        for i, row in enumerate(node):
            yield str(row.get("name", defaults[i] if i < len(defaults) else i)), i
    elif isinstance(node, list):
        yield from ((str(i), i) for i in range(len(node)))


def _default_names(table: Table) -> dict[str | int, list[str]]:
    """Return the names that bodies and obstacles have where the file gives them none."""
    bodies, obstacles = table.get("body", []), table.get("obstacle", [])
    base = table["joint"][0].get("parent", "") if table.get("joint") else ""
    names = default_names([*(row.get("frame", "") for row in bodies), *(base for _ in obstacles)])
    return {"body": list(names[: len(bodies)]), "obstacle": list(names[len(bodies) :])}


def _no_such(name: str, rest: str, known: Sequence[str]) -> str:
    before = name[: -len(rest) - 1] if len(rest) < len(name) else "the robot file"
    there = ", ".join(map(one_line, known)) or "no more numbers"
    return printable(f"no {one_line(rest)!r} in {one_line(before)}; there are {there}")
