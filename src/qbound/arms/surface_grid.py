"""Values on a grid, of only those boundary functions that may vanish nearby.

Of hundreds of boundary functions few come near to 0 in a part of joint space. A bound over each
block of the grid finds them, and only they are evaluated there.
"""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np

from qbound.arms.surface_forms import SurfaceForms, settled
from qbound.arrays import Floats

PLACES: Final = 6
"""Places of the grid that a block has along each axis."""


def grid_values(forms: SurfaceForms, grid: list[Floats]) -> tuple[SurfaceForms, Floats]:
    """Return the functions that may vanish on a grid, and the least of their values on it.

    Parameters
    ----------
    grid : list of ndarray
        Places along each of three axes, in even steps.

    Returns
    -------
    forms : SurfaceForms
    values : ndarray
        By the functions' sizes; where none can vanish, 1.
    """
    blocks = [range(0, len(places), PLACES) for places in grid]
    starts = list(product(*blocks))
    step = np.array([places[1] - places[0] for places in grid])
    low = np.array([places[0] for places in grid])
    middle = (PLACES - 1) / 2
    centres = low + step * (np.array(starts) + middle)
    active = forms.can_vanish(centres, middle * step)
    used = np.asarray(active.any(axis=0))
    forms, active = forms.only(used), active[:, used]
    values = np.ones([len(places) for places in grid])
    for start, which in zip(starts, active, strict=True):
        if which.any() or forms.walls:
            part = tuple(slice(k, k + PLACES) for k in start)
            axes = [places[each] for places, each in zip(grid, part, strict=True)]
            q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
            found = forms.relative(q.reshape(-1, 3), np.flatnonzero(which)).min(axis=1)
            values[part] = found.reshape(q.shape[:3])
    return forms, settled(values)
