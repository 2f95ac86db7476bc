"""A safe reader of XML files from strangers.

The file may have no document type, so there are no entities. The network is never used. The
encoding is UTF-8, whatever the file declares, and the size is limited. Every error names the file,
the line and the element.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Container
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np

from cspace.arrays import Floats
from cspace.extras import require
from cspace.model.robotcheck import RobotFileError
from cspace.model.rows import LARGEST
from cspace.model.schema import one_line, shown

LARGEST_FILE = 20_000_000
"""Bytes of a URDF or SRDF at most."""


PACKAGED = Path(str(resources.files("cspace"))) / "robots"
"""The folder of the files that come with the package."""


def called(path: Path) -> str:
    """Return the name of a file for messages: its path, or the bare name of a packaged file.

    Examples
    --------
    >>> called(PACKAGED / "ur5.urdf"), called(Path("mine/ur5.urdf"))
    ('ur5.urdf', 'mine/ur5.urdf')
    """
    return path.name if path.parent == PACKAGED else str(path)


class Source(NamedTuple):
    """A file that was read: its name, without its folder, and the digest of its bytes."""

    name: str
    sha256: str

    @classmethod
    def of(cls, path: Path, content: bytes) -> Source:
        """Return the source of a file with this content."""
        return cls(path.name, hashlib.sha256(content).hexdigest())


class Element:
    """An element of a file; errors about it name its place."""

    def __init__(self, node: Any, file: str, path: str) -> None:
        self._node = node
        self._file = file
        self.path = path

    @property
    def tag(self) -> str:
        """The name of the element."""
        return str(self._node.tag)

    @property
    def content(self) -> str:
        """The text inside the element."""
        return str(self._node.text or "").strip()

    def fault(self, text: str) -> NoReturn:
        """Refuse the file because of this element."""
        line = self._node.sourceline
        where = f"{one_line(self.path)}: " if self.path else ""
        raise RobotFileError(f"{self._file}, line {line}: {where}{text}")

    def children(self, tag: str | None = None) -> list[Element]:
        """Return the child elements, all or those of one name."""
        nodes = [node for node in self._node if isinstance(node.tag, str)]
        return [self._child(node) for node in nodes if tag is None or node.tag == tag]

    def child(self, tag: str) -> Element | None:
        """Return the only child element of that name, or None; two are refused."""
        found = self.children(tag)
        if len(found) > 1:
            found[1].fault(f"a second <{tag}>; one at most is wanted")
        return found[0] if found else None

    def text(self, key: str) -> str:
        """Return an attribute that must be there."""
        value = self._node.get(key)
        if not value:
            self.fault(f"{key} is missing")
        return str(value)

    def has(self, key: str) -> bool:
        """Tell whether the element has an attribute."""
        return self._node.get(key) is not None

    def number(self, key: str) -> float:
        """Return a finite number."""
        (value,) = self._numbers(key, self.text(key), 1)
        return float(value)

    def size(self, key: str) -> float:
        """Return a number above 0."""
        value = self.number(key)
        if value <= 0:
            self.fault(f"{key}: {value:g} is no size; wanted: more than 0")
        return value

    def vector(self, key: str, default: tuple[float, ...] | None = None, count: int = 3) -> Floats:
        """Return three finite numbers, or another count of them."""
        if default is not None and not self.has(key):
            return np.array(default, dtype=float)
        return self._numbers(key, self.text(key), count)

    def refuse_others(self, attributes: Container[str], known: str) -> None:
        """Refuse an attribute that is not among those given; those of other namespaces are let be.

        `known` lists the attributes for the message.
        """
        for key in self._node.keys():  # noqa: SIM118  # lxml's elements iterate over children
            if "}" not in key and key not in attributes:
                self.fault(f"attribute {shown(key)} is not read; known are: {known}")

    def _numbers(self, key: str, text: str, count: int) -> Floats:
        words = text.split()
        values = [_number(word) for word in words]
        if len(values) != count or not all(abs(value) <= LARGEST for value in values):
            wanted = "a finite number" if count == 1 else f"{count} finite numbers"
            self.fault(f"{key}: {shown(text)} found; wanted: {wanted}")
        return np.array(values)

    def _child(self, node: Any) -> Element:
        name = node.get("name")
        label = f"{node.tag} {name!r}" if name else f"<{node.tag}>"
        return Element(node, self._file, f"{self.path}, {label}" if self.path else label)


def read_xml(path: Path, root: str) -> tuple[Element, Source]:
    """Read a file whose outermost element has the name `root`; return it, and the file's digest.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        If the file cannot be read, is too large, is not XML, has a document type or another root.
    ModuleNotFoundError
        If lxml is missing; it comes with ``cspace[arms]``.
    """
    require("lxml")
    from lxml import etree

    content = _content(path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise RobotFileError(f"{called(path)}: not UTF-8 text") from None
    if match := re.search(r"<!\s*(DOCTYPE|ENTITY)", text, re.IGNORECASE):
        line = text.count("\n", 0, match.start()) + 1
        text = f"<!{match[1]}> found; a robot needs no document type and no entities"
        raise RobotFileError(f"{called(path)}, line {line}: {text}")
    parser = etree.XMLParser(
        encoding="utf-8", resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
    )
    try:
        node = etree.fromstring(text.encode(), parser)
    except etree.XMLSyntaxError as error:
        raise RobotFileError(f"{called(path)}: not XML: {error.msg}") from None
    unexpanded = re.search(r"\$[{(]", text)
    for each in node.iter():
        if isinstance(each.tag, str) and "xacro" in each.tag:
            if each.tag.endswith("}property") and not unexpanded:
                continue  # a constant that nothing uses
            text = "a xacro macro; expand the file first (xacro FILE -o arm.urdf)"
            raise RobotFileError(f"{called(path)}, line {each.sourceline}: {text}")
    if node.tag != root:
        raise RobotFileError(f"{called(path)}: <{one_line(str(node.tag))}> found; wanted: <{root}>")
    return Element(node, called(path), ""), Source.of(path, content)


def _content(path: Path) -> bytes:
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise RobotFileError(f"{called(path)}: more than {LARGEST_FILE // 10**6} MB")
        return path.read_bytes()
    except (OSError, ValueError) as error:
        raise RobotFileError(
            f"{called(path)}: {getattr(error, 'strerror', None) or error}"
        ) from None


def _number(word: str) -> float:
    """Read a number as other readers of URDF do: no underscores, only the digits 0 to 9."""
    try:
        return float(word) if re.fullmatch(r"[-+.\deE]+", word, re.ASCII) else math.nan
    except ValueError:
        return math.nan
