"""Values of a parsed file, each looked at before it is used; used by the strict readers alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NoReturn


def refuse(why: str) -> NoReturn:
    """Say in a sentence why a file is refused."""
    raise ValueError(why)


def shown(value: Any) -> str:
    """Write what was found, short and in ASCII."""
    if isinstance(value, str):
        return ascii(value[:60])
    return "nothing" if value is None else f"a {type(value).__name__}"


def keys(table: Any, where: str, wanted: Sequence[str], allowed: Sequence[str] = ()) -> None:
    """Refuse a table without a key that is wanted, or with one that is neither."""
    if not isinstance(table, dict):
        refuse(f"{where}: {shown(table)} is no table")
    for key in wanted:
        if key not in table:
            refuse(f"{where}: {key} is missing")
    for key in table:
        if key not in wanted and key not in allowed:
            refuse(f"{where}: {shown(key)} is no key of it")


def items(value: Any, where: str, fewest: int, most: int) -> list[Any]:
    """Return a list that has neither too few entries nor too many."""
    if not isinstance(value, list):
        refuse(f"{where}: {shown(value)} is no list")
    if not fewest <= len(value) <= most:
        wanted = str(most) if fewest == most else f"{fewest} to {most}"
        refuse(f"{where}: a list of {len(value)}, wanted {wanted}")
    return value


def text_of(value: Any, where: str) -> str:
    """Return a string."""
    if not isinstance(value, str):
        refuse(f"{where}: {shown(value)} is no text")
    return value
