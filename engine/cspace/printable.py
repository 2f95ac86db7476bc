"""Texts from outside, made safe to show: on one line, with every character that acts escaped.

A name in a file, a path or a wrong value may hold a command for the terminal (escape sequences), a
mark that reverses the text (bidirectional marks) or a line break. A name is escaped where it is
shown and not where it is read, because machines must get the name as it is.
"""


def printable(text: object) -> str:
    r"""Return a text on one line, with characters that do not print escaped as in Python.

    Control characters, newlines, bidirectional and other invisible marks and lone surrogates are
    escaped. Letters and signs of every script, and backslashes, are not.

    Examples
    --------
    >>> printable("x^2 & Größe"), printable("arm\x1b[2J\n\u202eda")
    ('x^2 & Größe', 'arm\\x1b[2J\\n\\u202eda')
    """
    line = str(text)
    return line if line.isprintable() else "".join(map(_escaped, line))


def _escaped(letter: str) -> str:
    return letter if letter.isprintable() else letter.encode("unicode_escape").decode()
