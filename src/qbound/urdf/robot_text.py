"""The text of an imported robot's file: one row on one line, and its origin in a comment on top.

Five hundred pairs of balls would fill thousands of lines if each were a table of its own.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

from qbound.extras import require
from qbound.model.robotfile import MADE, robot_table
from qbound.printable import printable
from qbound.urdf.arm import Imported

WIDTH = 100
"""Columns of a comment at most."""


def robot_text(imported: Imported) -> str:
    """Return the robot file of an imported robot.

    Its first lines are comments: the sources with their digests, the chain, the excess that is
    proved, and what was left out.

    Raises
    ------
    ModuleNotFoundError
        If there is no tomlkit; it comes with ``qbound[files]``.
    """
    require("tomlkit", "writing a robot file")
    lines = [*_header(imported)]
    for key, value in robot_table(imported.robot).items():
        if isinstance(value, list) and value and isinstance(value[0], Mapping):
            rows = [f"    {_inline(row)}," for row in value]
            lines += ["", f"{key} = [", *rows, "]"]
        else:
            lines.append(f"{key} = {_inline(value)}")
    return "\n".join(lines) + "\n"


def _header(imported: Imported) -> list[str]:
    chain = imported.chain
    texts = [
        f"{MADE.removeprefix('# ')} import, lengths in metres, from",
        *(f"  {source.name}, SHA-256 {source.sha256}" for source in imported.sources),
        f"Chain: from {chain.frames[0]} to {chain.tip}.",
        *(f"{note[0].upper()}{note[1:]}." for note in imported.notes),
    ]
    return [line for text in texts for line in _comment(text)]


def _comment(text: str) -> list[str]:
    return textwrap.wrap(
        printable(text),
        WIDTH,
        initial_indent="# ",
        subsequent_indent="#   ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _inline(value: Any) -> str:
    """Write a value on one line."""
    import tomlkit

    if isinstance(value, Mapping):
        pairs = (f"{_key(key)} = {_inline(item)}" for key, item in value.items())
        return f"{{ {', '.join(pairs)} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    return str(tomlkit.item(value).as_string())


def _key(key: str) -> str:
    """Write a key, in quotes where it needs them."""
    import tomlkit

    return tomlkit.key(key).as_string()
