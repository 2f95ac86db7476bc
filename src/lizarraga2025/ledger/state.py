"""Which state of the sources a citation names: a commit, and what Software Heritage calls its tree.

Between releases the version alone does not tell one state from the next. Committed files cannot
hold the commit that they are part of, so it is asked of git when a page or a citation is made.
"""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


@dataclass(frozen=True)
class State:
    """A state of the repository.

    Attributes
    ----------
    commit : str
        Its hash, 40 digits.
    swhid : str
        The tree's identifier at softwareheritage.org, the same wherever the tree lies; empty if
        files were changed since that commit.
    """

    commit: str
    swhid: str

    @property
    def text(self) -> str:
        """Words for a citation.

        Examples
        --------
        >>> State("0" * 40, "").text
        'commit 000000000000 with changes'
        """
        return f"commit {self.commit[:12]}" + ("" if self.swhid else " with changes")


@cache
def state(root: Path = ROOT) -> State | None:
    """Return the state of the repository around this package.

    None where there is none: an installed package, a copy without git.
    """
    if not (root / ".git").exists():
        return None
    try:
        commit, tree = _git(root, "rev-parse", "HEAD", "HEAD^{tree}").split()
        changed = _git(root, "status", "--porcelain", "--untracked-files=no")
    except (OSError, ValueError, subprocess.CalledProcessError):
        return None
    return State(commit, "" if changed else f"swh:1:dir:{tree}")


def _git(root: Path, *words: str) -> str:
    command = ["git", *words]
    done = subprocess.run(command, cwd=root, check=True, capture_output=True, encoding="utf-8")
    return done.stdout
