"""The second checker of certificates: it uses balls of Arb and shares no code with `check`.

The book's page "The certificate" defines what is checked. `reading` takes the file apart, `normal`
makes the normal form of the robot with the library's own reader, `cells` are boxes and simplices
and their trees, `waves` bounds what a robot does over a cell, and `proof` puts them together.
"""

from __future__ import annotations

from qbound.proofs import Verdict

__all__ = ["verify"]


def verify(text: str | bytes) -> Verdict:
    """Return the verdict of a certificate: its claim is proved or refuted.

    Parameters
    ----------
    text : str or bytes
        The certificate, format 6.

    Raises
    ------
    ValueError
        If the file does not follow the page, or does not prove its claim; the message is one
        sentence.
    ModuleNotFoundError
        Without python-flint (the extra `proofs`).

    Examples
    --------
    >>> verify("{}")
    Traceback (most recent call last):
    ValueError: the file: the key 'schema' is missing
    """
    from qbound.proofs.second.proof import verified

    return verified(text)
