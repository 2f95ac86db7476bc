"""When is a configuration feasible? Forms that must be positive, and tests that part two bodies.

Two convex parts are apart exactly if one of their clauses holds: an edge with all corners of the
other part beyond it, or two corners that are the nearest places and far enough apart. All in all a
configuration is feasible where every condition has a clause of which every form is positive. As
this only compares, it turns lower bounds of the forms into proofs, and safe steps into safe steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from qbound.boundary.contacts import NO_CONTACTS, SIDES, Contacts
from qbound.forms.factors import Kind
from qbound.forms.harmonic import HarmonicForm
from qbound.records import dataclass

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Conditions:
    """Forms of two joints, one a row, and what they are together.

    Attributes
    ----------
    forms : HarmonicForm, shape (rows,)
    clauses : ndarray of int, shape (clauses,)
        First row of each clause.
    starts : ndarray of int, shape (conditions,)
        First clause of each condition.
    """

    forms: HarmonicForm
    clauses: Ints
    starts: Ints

    def __len__(self) -> int:
        """Return the number of conditions: of forms, then of pairs of parts."""
        return len(self.starts)

    def together(self, values: Floats) -> Floats:
        """Return the least of each clause, of these the most of each condition.

        Shape (..., rows) to (..., conditions).
        """
        least = np.minimum.reduceat(values, self.clauses, axis=-1)
        return np.asarray(np.maximum.reduceat(least, self.starts, axis=-1))

    def worst(self, values: Floats) -> tuple[Ints, Ints]:
        """Return the condition that is least, and the row that decides it; (n, rows) to (n,)."""
        if not len(self):
            none = np.full(len(values), -1)
            return none, none
        least = np.minimum.reduceat(values, self.clauses, axis=1)
        together = np.maximum.reduceat(least, self.starts, axis=1)
        condition = together.argmin(axis=1)
        value = together[np.arange(len(values)), condition, None]
        sizes = np.diff(np.append(self.clauses, values.shape[1]))
        clause = np.repeat(np.arange(len(self.clauses)), sizes)
        of = np.searchsorted(self.starts, clause, side="right") - 1
        decides = (values == value) & (least[:, clause] == value) & (of == condition[:, None])
        return condition, decides.argmax(axis=1)


def conditions(
    forms: Sequence[HarmonicForm], contacts: Contacts = NO_CONTACTS, kinds: Sequence[Kind] = ()
) -> Conditions:
    """Gather conditions: one a form, in their order, then one for each pair of convex parts.

    Parameters
    ----------
    forms : sequence of HarmonicForm of two joints
    contacts : Contacts, optional
        Features of bodies that are to keep apart.
    kinds : sequence of two kinds of joints, optional
        Wanted where there is no form; default two turns.
    """
    own = np.array([form.coefficients for form in forms], dtype=float).reshape(-1, 3, 3)
    m, features = len(own), len(contacts.forms)
    # Of edges no side conditions are needed; of corners a constant 1 stands where there is none.
    silent = (contacts.sides.reshape(-1, SIDES, 9) == np.eye(9)[0]).all(axis=-1)
    said = contacts.corners[:, None] & ~silent
    feature, side = np.nonzero(said)
    of = np.concatenate([np.arange(m), m + np.arange(features), m + feature])
    rows = np.concatenate([own, contacts.forms, contacts.sides[feature, side]])
    order = np.argsort(of, kind="stable")
    clause = np.concatenate([np.arange(m), m + contacts.clause])[of[order]]
    condition = np.concatenate([np.arange(m), m + contacts.pair])[of[order]]
    first = np.flatnonzero(np.diff(clause, prepend=-1))
    found = forms[0].kinds if forms else (tuple(kinds) or ("revolute", "revolute"))
    starts = np.flatnonzero(np.diff(condition[first], prepend=-1))
    return Conditions(HarmonicForm(rows[order], found), first, starts)
