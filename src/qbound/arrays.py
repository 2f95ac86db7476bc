"""Names of array types, for annotations; a docstring says the shape and the unit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Complexes = NDArray[np.complex128]
Ints = NDArray[np.int64]
Indices = NDArray[np.intp]
Bools = NDArray[np.bool_]
Array = NDArray[Any]
"""Numbers of any kind: doubles, or objects such as rationals and balls."""
