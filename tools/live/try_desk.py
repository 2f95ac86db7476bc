"""The desk of the page "Try your own arm": the text of a robot file in, its explorer out."""

from __future__ import annotations

import json
import re
import time

from cspace import RobotFileError, find_region
from cspace.explorer.page import explorer_page
from cspace.model.robotfile import parse_robot


class Desk:
    """One place where robot files are tried."""

    def region(self, text: str) -> str:
        """Return the explorer of a robot with two joints, or what is wrong and in which line."""
        start = time.perf_counter()
        try:
            region = find_region(parse_robot(text))
            page = explorer_page(region)
        except RobotFileError as error:
            return json.dumps({"error": str(error), "line": line_of(str(error), text)})
        except (ValueError, ModuleNotFoundError) as error:
            return json.dumps({"error": str(error), "line": 0})
        seconds = round(time.perf_counter() - start, 3)
        parts = len(region.components)
        area = float(sum(component.area for component in region.components))
        return json.dumps({"page": page, "parts": parts, "area": area, "seconds": seconds})


def line_of(error: str, text: str) -> int:
    r"""Return the line of an error: the line that it names, or the line of its key; else 0.

    A row of a list such as ``joint`` is a table ``[[joint]]``, or a line with a brace.

    Examples
    --------
    >>> line_of("not TOML: Invalid value (at line 3, column 8)", "")
    3
    >>> line_of("joint[1].axis (elbow): [0] has length 1", "[[joint]]\n[[joint]]\naxis = [0]")
    3
    >>> line_of("unknown key 'nam'; allowed: name", "schema = 1\nnam = 'arm'")
    2
    """
    if named := re.search(r"\bline (\d+)", error):
        return int(named[1])
    path = re.match(r"(\w+)(?:\[(\d+)\])?(?:\.\w+)*", error)
    quoted = re.match(r"unknown key '([^']+)'", error)
    if not path:
        return 0
    lines = text.splitlines()
    table, last = (quoted[1],) * 2 if quoted else (path[1], path[0].rpartition(".")[2])
    first = row_of(lines, table, -1 if path[2] is None else int(path[2]))
    after = (k for k in range(max(first, 1), len(lines) + 1) if gives(lines[k - 1], last))
    return next(after, first)


def row_of(lines: list[str], table: str, n: int) -> int:
    """Return the line in which the n-th row of a list begins (-1: that of the key itself); or 0."""
    heads = [k for k, line in enumerate(lines, 1) if line.strip().startswith(f"[[{table}]]")]
    if len(heads) > n >= 0:
        return heads[n]
    first = next((k for k, line in enumerate(lines, 1) if gives(line, table)), 0)
    rows = [k for k in range(first, len(lines) + 1) if first and "{" in lines[k - 1]]
    return rows[n] if len(rows) > n >= 0 else first


def gives(line: str, key: str) -> bool:
    """Tell whether a line gives a value to a key."""
    return re.search(rf"(?:^|[\s{{,.]){re.escape(key)}\s*=", line) is not None
