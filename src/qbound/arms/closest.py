"""The search for where two links come closest, in floats: what it finds is verified elsewhere.

Along one joint every form is ``c0 + a cos q + b sin q``, or a quadratic, so that its least value
is closed form. Joint after joint, from the best of many random configurations.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from qbound.arms.pair_forms import PairForms
from qbound.arrays import Floats
from qbound.forms.angles import TURN
from qbound.forms.factors import basis
from qbound.forms.harmonic import HarmonicForm, Kind

Ints = NDArray[np.intp]

SAMPLES = 2048
"""Random configurations of a pair of links."""

STARTS = 3
"""Of these, the starts for each pair of balls."""

SWEEPS = 40
"""Times that every joint is moved to where the form is least."""


@dataclass(frozen=True, eq=False)
class Witnesses:
    """What a search has seen of a pair of links, in the joints that matter.

    Attributes
    ----------
    nearest : ndarray, shape (n,)
        Where two balls were nearest, by floats.
    form : int
        These two.
    gap : float
        Between their surfaces; length.
    touching, apart : ndarray or None, shape (n,)
        Configurations with contact and without, verified in exact numbers.
    """

    nearest: Floats
    form: int
    gap: float
    touching: Floats | None = None
    apart: Floats | None = None

    @classmethod
    def of(cls, pair: PairForms, places: Floats) -> Witnesses:
        """Look at configurations, shape (N, n)."""
        gaps = pair.gaps(places)
        at, form = np.unravel_index(gaps.argmin(), gaps.shape)
        nearest, farthest = places[at], places[gaps.min(axis=1).argmax()]
        found = cls(nearest, int(form), pair.gap(nearest, int(form)))
        return replace(
            found,
            touching=nearest if _touches(pair, nearest) else None,
            apart=farthest if _keeps_apart(pair, farthest) else None,
        )

    def with_place(self, pair: PairForms, place: Floats) -> Witnesses:
        """Look at one more configuration, and at where balls come closest from there.

        Returns itself where that tells nothing new.
        """
        which = np.arange(len(pair.names))
        more = descended(pair, np.repeat(place[None], len(which), axis=0), which)
        new = Witnesses.of(pair, np.concatenate([place[None], more]))
        best = new if new.gap < self.gap else self
        touching = new.touching if self.touching is None else self.touching
        apart = new.apart if self.apart is None else self.apart
        if best is self and touching is self.touching and apart is self.apart:
            return self
        return replace(best, touching=touching, apart=apart)


def _touches(pair: PairForms, q: Floats) -> bool:
    return pair.contains(q) and any(bool(value <= 0) for value in pair.exact(q))


def _keeps_apart(pair: PairForms, q: Floats) -> bool:
    return pair.contains(q) and all(bool(value > 0) for value in pair.exact(q))


def random_configurations(pair: PairForms, seed: int) -> Floats:
    """Return configurations within the ranges of the joints that matter, shape (N, n)."""
    low, high = pair.box
    rng = np.random.default_rng(seed)
    return np.asarray(low + (high - low) * rng.random((SAMPLES, len(low))))


def closest(pair: PairForms, samples: Floats) -> Floats:
    """Return configurations at which each form is low, one after the other, shape (STARTS m, n).

    They are the best of the samples, moved joint by joint while a form falls.
    """
    order = np.argsort(pair.values(samples), axis=0)[:STARTS]  # (STARTS, m)
    which = np.broadcast_to(np.arange(order.shape[1]), order.shape).ravel()
    return descended(pair, samples[order.ravel()], which)


def descended(pair: PairForms, q: Floats, which: Ints) -> Floats:
    """Move each configuration, joint by joint, to where its form is least, shape (N, n).

    Parameters
    ----------
    which : ndarray of int, shape (N,)
        The form of each configuration.
    """
    q = np.array(q, dtype=float)
    forms = pair.floats[which]
    low, high = pair.box
    for _ in range(SWEEPS):
        before = q.copy()
        for j in range(q.shape[1]):
            along = along_each(forms, j, q)
            q[:, j] = least_place(pair.floats.kinds[j], along, low[j], high[j])
        if np.allclose(q, before, rtol=0, atol=1e-9):
            break
    return q


def along_each(forms: HarmonicForm, joint: int, q: Floats) -> Floats:
    """Return the coefficients of form k along a joint at configuration k, shape (N, 3)."""
    result = np.moveaxis(forms.coefficients, joint + 1, 1)
    for j in reversed([j for j in range(q.shape[1]) if j != joint]):
        result = np.einsum("n...c,nc->n...", result, basis(forms.kinds[j], q[:, j]))
    return np.asarray(result)


def least_place(kind: Kind, along: Floats, low: float, high: float) -> Floats:
    """Return where one-joint forms are least between two limits, shape (N,) (eqs. 30-36).

    Parameters
    ----------
    along : ndarray, shape (N, 3)
        Coefficients on (1, cos q, sin q) or (1, q, q²).
    """
    c1, c2 = along[:, 1], along[:, 2]
    if kind == "revolute":
        inner = np.arctan2(-c2, -c1)
        inner = inner + TURN * np.ceil((low - inner) / TURN)
    else:
        inner = np.divide(-c1, 2 * c2, out=np.full(len(c1), low), where=c2 > 0)
    ends = np.stack([np.full(len(c1), low), np.full(len(c1), high), np.clip(inner, low, high)])
    values = np.einsum("kni,ni->kn", basis(kind, ends), along)
    best = values.argmin(axis=0)
    return np.asarray(ends[best, np.arange(len(c1))])
