"""What is wrong with data by a JSON Schema of the package, said in one sentence.

Schemas describe themselves: their `description` reads on after "is not" and "wanted:".
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator

Place = Sequence[str | int]

LONGEST = 60
"""Characters of a value that a message shows."""


class Fault(NamedTuple):
    """One keyword of a schema that does not hold."""

    path: Place
    keyword: str
    asked: Any
    """What the schema has beside the keyword."""
    found: Any
    schema: Mapping[str, Any]


def first_fault(schema: str, value: Any) -> tuple[Place, str] | None:
    """Return the place and the sentence of the first fault, in the order of the file.

    Parameters
    ----------
    schema : str
        Name of the schema: "robot", "results".
    value : table or list
        The content of a file; tables keep the order of the file.

    Returns
    -------
    tuple of path and str, or None
        None if there is no fault.
    """
    faults = _faults(schema, value)
    first = min(faults, key=lambda fault: _position(value, fault), default=None)
    return None if first is None else (first.path, SENTENCES[first.keyword](first))


def place(value: Any, path: Place) -> str:
    """Write a place as a reader looks for it: ``joint[0].axis (q1)``, by index and by name."""
    steps = (f"[{step}]" if isinstance(step, int) else f".{_key(step)}" for step in path)
    dotted = "".join(steps).lstrip(".")
    if len(path) < 2 or not isinstance(path[1], int):
        return dotted
    row = value[path[0]][path[1]]
    name = row.get("name") if isinstance(row, Mapping) else None
    in_its_name = tuple(path[2:]) == ("name",)
    return dotted if in_its_name or not isinstance(name, str) else f"{dotted} ({one_line(name)})"


def shown(value: Any) -> str:
    """Write a value on one line, about as the file has it; the end of a long one is left out."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        return one_line(hex(value))  # Python writes no integer of thousands of digits in decimals
    if isinstance(value, list):
        return one_line(f"[{', '.join(shown(item) for item in value[:LONGEST])}]")
    return one_line(repr(value) if isinstance(value, str) else str(value))


def one_line(text: str) -> str:
    """Keep a text on one line and short."""
    line = text if text.isprintable() else repr(text)[1:-1]
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."


@cache
def _validator(schema: str) -> Draft202012Validator:
    from jsonschema import Draft202012Validator  # where it is needed: the import is slow

    file = resources.files("qbound") / "schemas" / f"{schema}.schema.json"
    return Draft202012Validator(json.loads(file.read_text(encoding="utf-8")))


def _faults(schema: str, value: Any) -> Iterator[Fault]:
    for e in _validator(schema).iter_errors(value):
        rule: Any = e.schema
        yield Fault(tuple(e.absolute_path), str(e.validator), e.validator_value, e.instance, rule)


def _position(value: Any, fault: Fault) -> list[int]:
    """Return where a fault stands in the file: one number a level, to sort by.

    An unknown key stands where it is written, a missing one at the end of its table.
    """
    position = []
    for step in fault.path:
        position.append(step if isinstance(step, int) else list(value).index(step))
        value = value[step]
    if fault.keyword == "additionalProperties":
        position.append(list(value).index(_unknown(fault)[0]))
    if fault.keyword == "required":
        position.append(len(value))
    return position


def _unknown_key(fault: Fault) -> str:
    keys = _unknown(fault)
    found = one_line(", ".join(map(repr, keys)))
    allowed = ", ".join(fault.schema["properties"])
    return f"unknown key{'s' * (len(keys) > 1)} {found}; allowed: {allowed}"


def _missing_key(fault: Fault) -> str:
    keys = [key for key in fault.asked if key not in fault.found]
    verb = "is" if len(keys) == 1 else "are"
    return f"{', '.join(map(repr, keys))} {verb} missing; needed: {', '.join(fault.asked)}"


def _wrong_choice(fault: Fault) -> str:
    choices = fault.asked if fault.keyword == "enum" else [fault.asked]
    return f"{shown(fault.found)} is unknown; allowed: {', '.join(map(str, choices))}"


def _wrong_type(fault: Fault) -> str:
    return f"{shown(fault.found)} is not {_wanted(fault)}"


def _wrong_length(fault: Fault) -> str:
    return f"{shown(fault.found)} has length {len(fault.found)}; wanted: {_wanted(fault)}"


def _too_small(fault: Fault) -> str:
    words = "at least" if fault.keyword == "minimum" else "more than"
    return f"{shown(fault.found)} is too small; allowed: {words} {fault.asked}"


def _repeated(fault: Fault) -> str:
    return f"{shown(fault.found)} names one thing twice; wanted: {_wanted(fault)}"


SENTENCES: Mapping[str, Callable[[Fault], str]] = {
    "additionalProperties": _unknown_key,
    "required": _missing_key,
    "enum": _wrong_choice,
    "const": _wrong_choice,
    "type": _wrong_type,
    "minLength": _wrong_length,
    "minItems": _wrong_length,
    "maxItems": _wrong_length,
    "minProperties": _wrong_length,
    "minimum": _too_small,
    "exclusiveMinimum": _too_small,
    "uniqueItems": _repeated,
}
"""From the keyword of a schema that fails to the sentence that says how."""


def _wanted(fault: Fault) -> str:
    """Return what the schema asks for, in its own words or by the name of the type."""
    types = {"number": "a number", "string": "a text", "boolean": "true or false"}
    types |= {"object": "a table", "array": "a list"}
    return str(fault.schema.get("description") or types[fault.schema["type"]])


def _unknown(fault: Fault) -> list[str]:
    return [key for key in fault.found if key not in fault.schema["properties"]]


def _key(key: str) -> str:
    """Write a key as TOML does: bare if it can be."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else one_line(repr(key))
