"""Booleans as text, for the lines between peers and harness."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np


def bits(judged: Any) -> str:
    """Return an array of booleans as text: what `unpacked` reads."""
    packed = np.packbits(np.asarray(judged, dtype=bool)).tobytes()
    return base64.b64encode(zlib.compress(packed, 1)).decode()


def unpacked(text: str, count: int) -> np.ndarray:
    """Return the booleans that `bits` has packed."""
    packed = np.frombuffer(zlib.decompress(base64.b64decode(text)), dtype=np.uint8)
    return np.unpackbits(packed, count=count).astype(bool)
