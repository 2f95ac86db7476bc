"""Conditions of a feasible configuration: forms that must be positive, and clauses for bodies.

Two convex parts are apart exactly if one of their clauses holds: all corners of one part lie beyond
an edge of the other, or two corners are the nearest places and far enough apart. So a configuration
is feasible if every condition has a clause in which every form is positive. This only compares
values. So it turns lower bounds of the forms into proofs, and safe steps of forms into safe steps
of bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from qbound.arrays import Floats, Ints
from qbound.boundary.contacts import NO_CONTACTS, SIDES, Contacts
from qbound.forms.harmonic import HarmonicForm


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

    @cached_property
    def clause_of(self) -> Ints:
        """The clause of each row, shape (rows,)."""
        sizes = np.diff(np.append(self.clauses, len(self.forms.coefficients)))
        return np.repeat(np.arange(len(self.clauses)), sizes)

    @cached_property
    def condition_of(self) -> Ints:
        """The condition of each row, shape (rows,)."""
        return np.searchsorted(self.starts, self.clause_of, side="right") - 1

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
        decides = (values == value) & (least[:, self.clause_of] == value)
        decides &= self.condition_of == condition[:, None]
        return condition, decides.argmax(axis=1)


def conditions(forms: HarmonicForm, contacts: Contacts = NO_CONTACTS) -> Conditions:
    """Gather conditions: one a form, in their order, then one for each pair of convex parts.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Of two joints, as `Problem.forms` has them. A stack of none still says what the joints are,
        which the tables of the contacts do not.
    contacts : Contacts, optional
        Features of bodies that are to keep apart, of the same two joints.

    Raises
    ------
    ValueError
        If the forms are no stack, or not of two joints.
    """
    if len(forms.kinds) != 2 or len(forms.shape) != 1:
        raise ValueError(
            f"wanted a stack of forms of two joints, such as Problem.forms; found the shape"
            f" {forms.shape} and {len(forms.kinds)} joints"
        )
    own = forms.coefficients
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
    starts = np.flatnonzero(np.diff(condition[first], prepend=-1))
    return Conditions(HarmonicForm(rows[order], forms.kinds), first, starts)
