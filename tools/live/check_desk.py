"""The desk of the page "Check a certificate here": hands files to `check.py`."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import time
from pathlib import Path

import check  # the one file of the checker, as the book shows it


class Desk:
    """One place where certificates are checked."""

    def about(self) -> str:
        """Return the SHA-256 and the text of the checker that runs here."""
        text = Path(check.__file__).read_bytes()
        return json.dumps({"sha256": hashlib.sha256(text).hexdigest(), "text": text.decode()})

    def check(self, certificate: str, robot: str) -> str:
        """Return exit status and words of the checker for a file, and for a robot file if named."""
        said, start = io.StringIO(), time.perf_counter()
        with contextlib.redirect_stdout(said):
            status = check.main([certificate, *(["--robot", robot] if robot else [])])
        seconds = round(time.perf_counter() - start, 3)
        return json.dumps({"status": status, "said": said.getvalue().strip(), "seconds": seconds})
