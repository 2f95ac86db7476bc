"""Changes of the table that a robot file is, by places written as its errors write them."""

import re
from collections.abc import Callable
from typing import Any

Table = dict[str, Any]
Change = Callable[[Table], Any]


def _holder(table: Any, place: str) -> tuple[Any, Any]:
    """Return the table or list that holds a place such as joint[0].axis, and its key there."""
    *path, last = [int(p) if p.isdigit() else p for p in re.findall(r"\w+", place)]
    for key in path:
        table = table[key]
    return table, last


def put(place: str, value: Any) -> Change:
    """A change that puts a value at a place."""

    def change(table: Table) -> None:
        holder, last = _holder(table, place)
        holder[last] = value

    return change


def drop(place: str) -> Change:
    """A change that takes a place away."""

    def change(table: Table) -> None:
        holder, last = _holder(table, place)
        del holder[last]

    return change
