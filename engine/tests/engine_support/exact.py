"""Problems for the proofs: rational coefficients, balls for limits."""

import numpy as np
from flint import arb, fmpq

from cspace.proofs.exact.problem import ExactProblem
from engine_support.forms import LIMITS, ROUND, forms
from qbound.forms import HarmonicForm


def stated(kinds, terms, ranges=ROUND) -> ExactProblem:
    """A problem with rational coefficients, from the rows of the edge table."""
    stack = forms(kinds, *terms)
    exact = [fmpq(*float(c).as_integer_ratio()) for c in stack.coefficients.ravel()]
    table = np.empty(stack.coefficients.shape, dtype=object)
    table.ravel()[:] = exact
    balls = tuple(None if r is None else (arb(r[0]), arb(r[1])) for r in ranges)
    names = tuple(f"f{i}" for i in range(len(terms)))
    return ExactProblem(HarmonicForm(table, kinds), names, balls, LIMITS)
