"""How is a text from outside shown to people? On one line, with nothing in it that acts.

A name in a file, a path or a wrong value may hold what a terminal obeys (escape sequences), what
turns a line round (bidirectional marks) or what begins another line.
"""

from __future__ import annotations


def printable(text: object) -> str:
    r"""Write a text on one line: what does not print is escaped as Python escapes it.

    Control characters, newlines, bidirectional and other invisible marks and lone surrogates do
    not print; letters and signs of every script do, a backslash included.

    Examples
    --------
    >>> printable("x^2 & Größe"), printable("arm\x1b[2J\n\u202eda")
    ('x^2 & Größe', 'arm\\x1b[2J\\n\\u202eda')
    """
    line = str(text)
    return line if line.isprintable() else "".join(map(_escaped, line))


def _escaped(letter: str) -> str:
    return letter if letter.isprintable() else letter.encode("unicode_escape").decode()
