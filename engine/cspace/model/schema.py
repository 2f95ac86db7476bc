"""Sentences about wrong data: the place, what stands there, and what its class allows.

msgspec finds the first fault in the order of the file, with its place and kind. The JSON Schema of
the same classes tells what is allowed there; its `description` continues the words "is not" and
"wanted:".
"""

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from cspace.printable import printable

JsonPath = Sequence[str | int]
Node = Mapping[str, Any]
"""What a JSON Schema has to say of one place."""

LONGEST = 60
"""Characters of a value that a message shows."""


def explained(message: str, table: Any, schema: Node) -> tuple[JsonPath, str]:
    """Return the place and the sentence of a fault that msgspec found.

    Parameters
    ----------
    message : str
        Message of msgspec: the kind of the fault, then the place, as in
        ``... - at `$.joint[0].axis```.
    table : dict
        The content of the file.
    schema : dict
        JSON Schema of the same classes.
    """
    located = re.search(r" - at `\$([^`]*)`$", message)
    path, found, node = _follow(located[1] if located else "", table, schema)
    sort = message[: located.start()] if located else message
    return path, _sentence(sort, found, node)


def place(value: Any, path: JsonPath) -> str:
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
    """Write a value on one line, similar to the file; the end of a long value is left out."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        return one_line(hex(value))  # Python does not print integers of thousands of digits
    if isinstance(value, list):
        return one_line(f"[{', '.join(shown(item) for item in value[:LONGEST])}]")
    return one_line(repr(value) if isinstance(value, str) else str(value))


def leaves(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[JsonPath, Any]]:
    """Yield every number and text of a file, with its place."""
    if isinstance(value, Mapping | list):
        items = value.items() if isinstance(value, Mapping) else enumerate(value)
        for step, item in items:
            yield from leaves(item, (*path, step))
    else:
        yield path, value


def one_line(text: str) -> str:
    """Keep a text on one line and short."""
    line = printable(text)
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."


def _follow(where: str, value: Any, schema: Node) -> tuple[JsonPath, Any, Node]:
    """Follow a path: return the path, the value found there, and the schema of that value."""
    path: list[str | int] = []
    node = _resolved(schema, schema, value)
    for key, index in re.findall(r"\.(\w+)|\[([\d.]+)\]", where):
        step = key or (_wrong_number(value, node) if index == "..." else int(index))
        inner = (
            node["properties"][key] if key else node.get("items", node.get("additionalProperties"))
        )
        value = value[step]
        node = _resolved(inner, schema, value)
        path.append(step)
    return path, value, node


def _resolved(node: Node, schema: Node, value: Any) -> Node:
    """Replace a reference by its target, and a choice of tables by the table of the given type."""
    if "$ref" in node:
        found: Node = schema["$defs"][node["$ref"].rpartition("/")[2]]
        return found
    if "discriminator" not in node:
        return node
    choices = node["discriminator"]["mapping"]
    tag = value.get("type") if isinstance(value, Mapping) else None
    if isinstance(tag, str) and tag in choices:
        return _resolved({"$ref": choices[tag]}, schema, value)
    tables = [_resolved({"$ref": reference}, schema, value) for reference in choices.values()]
    needed = [key for key in tables[0]["required"] if all(key in t["required"] for t in tables)]
    return {**tables[0], "required": needed, "properties": {"type": {"enum": [*choices]}}}


def _wrong_number(table: Mapping[str, Any], node: Node) -> str:
    """Return the key, in a table of numbers, that msgspec leaves out of the place of a fault."""
    most = node["additionalProperties"].get("maximum", sys.float_info.max)
    return next(k for k, x in table.items() if type(x) not in (int, float) or not abs(x) <= most)


def _sentence(sort: str, value: Any, node: Node) -> str:
    """Say all about a fault, of the sort that msgspec begins to say."""
    if sort.startswith("Object contains unknown field"):
        keys = [key for key in value if key not in node["properties"]]
        names = one_line(", ".join(map(repr, keys)))
        allowed = ", ".join(node["properties"])
        return f"unknown key{'s' * (len(keys) > 1)} {names}; allowed: {allowed}"
    if sort.startswith("Object missing required field"):
        keys = [key for key in node["required"] if key not in value]
        verb = "is" if len(keys) == 1 else "are"
        return f"{', '.join(map(repr, keys))} {verb} missing; needed: {', '.join(node['required'])}"
    wrong_type = re.match(r"Expected `\w+`, got", sort)
    if sort.startswith("Invalid") or (wrong_type and "enum" in node):
        return f"{shown(value)} is unknown; allowed: {', '.join(map(str, node['enum']))}"
    if wrong_type:
        return f"{shown(value)} is not {_wanted(node)}"
    if re.match(r"Expected `\w+` of length", sort):
        return f"{shown(value)} has length {len(value)}; wanted: {_wanted(node)}"
    if re.match("Expected `(float|int)` >", sort):
        more = "exclusiveMinimum" in node
        least = f"more than {node['exclusiveMinimum']}" if more else f"at least {node['minimum']}"
        return f"{shown(value)} is too small; allowed: {least}"
    if re.match("Expected `(float|int)` <", sort):
        return f"{shown(value)} is too large; allowed: at most {node['maximum']}"
    return f"{shown(value)}: {one_line(sort)}"


def _wanted(node: Node) -> str:
    """Return what the schema allows: its description, else the name of the type."""
    types = {
        "number": "a number",
        "integer": "a whole number",
        "string": "a text",
        "boolean": "true or false",
    }
    types |= {"object": "a table", "array": "a list"}
    in_words = "description" in node and "title" not in node  # a title: the class of a table
    return str(node["description"] if in_words else types[node["type"]])


def _key(key: str) -> str:
    """Write a key as TOML does: bare if it can be."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else one_line(repr(key))
