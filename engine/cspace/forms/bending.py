r"""Bounds of how much a form bends within a simplex, and the lower bound of the form that follows.

Along a step d the second derivative of a wave :math:`\mathrm{Re}\,A e^{i w \cdot q}` is at most
:math:`|A| (w \cdot d)^2` in absolute value. For the centre m of a simplex and d within it

.. math::

   \beta(m + d) \ge \beta(m) + \nabla\beta(m) \cdot d - \tfrac12 \sum_k |A_k| (w_k \cdot d)^2 ,

and the right side is concave in d: its least value over the simplex is at a corner. Not in the
paper; the search for certificates, their checker and the scaling of polygons rest on it.
"""

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats
from cspace.forms.harmonic import Waves, derivatives, waves
from cspace.geometry.simplices import edges
from qbound.forms import HarmonicForm


def second_order(form: HarmonicForm, cells: Floats) -> Floats:
    """Return lower bounds of each form on each simplex; rounding is not included.

    Parameters
    ----------
    cells : ndarray, shape (N, k, n)
        Corners: N points, segments, triangles, ...

    Returns
    -------
    ndarray, shape (N,) + form.shape
    """
    centre = cells.mean(axis=1)
    steps = cells - centre[:, None]
    slope = np.einsum("nkj,n...j->nk...", steps, derivatives(form)(centre))
    bend = bending(form, cells, steps, concave=True)
    return np.asarray((form(centre)[:, None] + slope - bend / 2).min(axis=1))


def bending(
    form: HarmonicForm,
    cells: Floats,
    steps: Floats,
    *,
    concave: bool = False,
    upwards: bool = False,
) -> Floats:
    r"""Bound minus the second derivative along steps, anywhere in the cells.

    Parameters
    ----------
    cells : ndarray, shape (N, c, n)
        Corners of the cells.
    steps : ndarray, shape (N, k, n)
    concave : bool
        Whether the bounds have to hold for every mean of the steps too; then they are convex in the
        step.
    upwards : bool
        Whether to count squares that bend upwards too. A bound by tangents holds without them, but
        on a long cell it lies far below the form.

    Returns
    -------
    ndarray, shape ``(N, k, *form.stack)``

    Notes
    -----
    A wave times sliding joints, :math:`f = \mathrm{Re}\,A e^{iu} \prod q_j`, is bounded by the
    product rule factor after factor, :math:`(fq)'' = f''q + 2f'd`, with the largest abs(q) of the
    cell. That is not convex in the step, and the largest of the steps stands for all. A lone
    square with a positive amplitude bends upwards: it counts for nothing, unless asked for.
    """
    terms = waves(form)
    size = np.abs(terms.amplitudes)
    u, far = np.abs(steps @ terms.turns.T), np.abs(steps)
    bend = np.square(u)
    if terms.powers.any():
        if concave:
            sliding = terms.powers.any(axis=1)
            u = np.where(sliding, u.max(axis=1, keepdims=True), u)
            far = np.broadcast_to(far.max(axis=1, keepdims=True), far.shape)
        bend = with_slides(terms, np.abs(cells).max(axis=1), u, far)
        lone = (terms.powers == 2).any(axis=1) & (terms.powers.sum(axis=1) == 2)
        rising = lone & ~terms.turns.any(axis=1) & (terms.amplitudes.real > 0)
        size = np.where(rising & (not upwards), 0, size)
    return np.tensordot(bend, size, axes=([-1], [-1]))


def worst_edges(
    form: HarmonicForm, cells: Floats, which: NDArray[np.intp] | None = None
) -> NDArray[np.intp]:
    """Return for each simplex the edge along which a form may bend most; the simplex is cut there.

    Parameters
    ----------
    which : ndarray of int, shape (N,), optional
        For a stack, the form that counts on each cell.

    Returns
    -------
    ndarray of int, shape (N,)
        Numbers of edges, in the order of `simplices.edges`; the longest edge where nothing bends.
    """
    steps = edges(cells)
    bend = bending(form, cells, steps, upwards=True)
    if which is not None:
        bend = bend[np.arange(len(cells)), :, which]
    flat = bend.max(axis=1, keepdims=True) <= 0
    return np.asarray(np.where(flat, np.square(steps).sum(axis=2), bend).argmax(axis=1))


def with_slides(waves: Waves, reach: Floats, u: Floats, far: Floats) -> Floats:
    """Bound the second derivative of every wave of amplitude 1, shape (N, k, m)."""
    y, dy, ddy = np.ones_like(u), u, np.square(u)
    for j, powers in enumerate(waves.powers.T):
        q, d = reach[:, None, j, None], far[:, :, j, None]
        for power in range(powers.max()):
            has = powers > power
            ddy = np.where(has, ddy * q + 2 * dy * d, ddy)
            y, dy = np.where(has, y * q, y), np.where(has, dy * q + y * d, dy)
    return ddy


def extremes(tables: Floats, turns: tuple[bool, bool]) -> tuple[Floats, Floats]:
    """Return values that forms of two joints, tables (..., 3, 3), do not leave: lowest and highest.

    A joint that turns does so all the way round; a slide's values are at most 1.
    """
    first, second, product = tables[..., 1:, 0], tables[..., 0, 1:], tables[..., 1:, 1:]
    by_base, by_lift = (
        np.hypot(c[..., 0], c[..., 1]) if turn else np.abs(c).sum(axis=-1)
        for c, turn in zip((first, second), turns, strict=True)
    )
    if all(turns):  # the largest singular value
        a, b, c, d = (product[..., i, j] for i in (0, 1) for j in (0, 1))
        gap = np.hypot(a * a + b * b - c * c - d * d, 2 * (a * c + b * d))
        both = np.sqrt((product**2).sum(axis=(-2, -1)) / 2 + gap / 2)
    else:
        turn = turns[1]
        over = np.hypot(*np.moveaxis(product, -1, 0)) if turn else np.abs(product).sum(axis=-1)
        turn = turns[0]
        both = np.hypot(*np.moveaxis(over, -1, 0)) if turn else over.sum(axis=-1)
    reach = by_base + by_lift + both
    return tables[..., 0, 0] - reach, tables[..., 0, 0] + reach
