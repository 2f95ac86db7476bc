"""The content of a robot file, read once: its text, and its table with doubles and with rationals.

A robot keeps the source that it was read from. So exact numbers, certificates and copies of the
file need neither the file nor a TOML reader again.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from typing import Any

from cspace.model.robotcheck import RobotFileError, Table

LARGEST_EXPONENT = 400
"""Powers of ten beyond a double's range; a number with more would need astronomical fractions."""


class Written(float):
    """A decimal of a file: the double nearest to it, and its digits."""

    __slots__ = ("digits",)
    digits: str

    def __new__(cls, digits: str) -> Written:
        """Read the digits."""
        number = super().__new__(cls, digits)
        number.digits = digits
        return number


@dataclass(frozen=True, eq=False)
class Source:
    """The content that a robot was read from.

    Attributes
    ----------
    written : mapping
        Content of the file. A decimal of a text is `Written`; a table made in a program keeps its
        numbers.
    text : str
        Text of the file; empty for a table made in a program.

    Examples
    --------
    >>> source = Source.of_text("reach = 0.1")
    >>> source.table, source.exact
    ({'reach': 0.1}, {'reach': 1/10})
    """

    written: Table
    text: str = ""

    @classmethod
    def of_text(cls, text: str) -> Source:
        """Read TOML.

        Raises
        ------
        ValueError
            If the text is not TOML.
        """
        try:
            return cls(tomllib.loads(text, parse_float=Written), text)
        except (ValueError, RecursionError) as error:  # also an integer or a nesting without end
            raise RobotFileError(f"not TOML: {error}") from None

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the tables that are made from the content: rationals cannot be copied."""
        return {"written": self.written, "text": self.text}

    @cached_property
    def table(self) -> Table:
        """The content with doubles."""
        table: Table = _with_numbers(self.written, float) if self.text else self.written
        return table

    @cached_property
    def exact(self) -> Table:
        """The content with decimals as rationals; a table made in a program is unchanged.

        Raises
        ------
        ValueError
            If a number has an exponent that no double could hold.
        """
        table: Table = _with_numbers(self.written, _rational)
        return table


def _with_numbers(value: Any, number: Callable[[Written], Any]) -> Any:
    """Replace all decimals of a table."""
    if isinstance(value, Written):
        return number(value)
    if isinstance(value, Mapping):
        return {key: _with_numbers(item, number) for key, item in value.items()}
    return [_with_numbers(item, number) for item in value] if isinstance(value, list) else value


def _rational(number: Written) -> Any:
    from flint import fmpq

    decimal = Decimal(number.digits)
    if decimal and abs(decimal.adjusted()) > LARGEST_EXPONENT:
        text = f"{number.digits}: an exponent this far from 0 cannot be used in a proof"
        raise ValueError(text)
    return fmpq(*decimal.as_integer_ratio())
