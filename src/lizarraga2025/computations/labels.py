"""Equations (1) to (8): labels of frames and vectors, in general rotations."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.proofs import UNTURNED, general, vanishes
from lizarraga2025.verdicts import Outcome, judge
from qbound.frames import Frame, Frames


@computes("E-1")
def frame() -> Outcome:
    g = general()
    o_ab = g.chain.frame("a", "b")
    columns = vanishes(o_ab[:, :3] - g.R_ab) and vanishes(o_ab[:, 3] - g.r_ab)
    orthonormal = vanishes(g.R_ab.T @ g.R_ab - UNTURNED)
    rows, width = o_ab.shape
    return Outcome(
        judge(holds=columns and orthonormal and (rows, width) == (3, 4)),
        f"For every rotation and vector the library's frame is {rows} by {width}, its columns are"
        " those of R and r, and the transpose of R times R is the identity: no remainder.",
    )


@computes("E-2")
def frame_of_itself() -> Outcome:
    chain = general().chain
    own = [chain.frame(name, name) - np.eye(3, 4, dtype=int) for name in ("a", "b")]
    return Outcome(
        judge(holds=all(map(vanishes, own))),
        f"Computed, not set: {len(own)} frames with general rotations, seen from themselves, leave"
        " no remainder against [I 0].",
    )


@computes("E-3")
def vector_and_observer() -> Outcome:
    g = general()
    from_0, from_a = (g.chain.position("a+n", "b+m", observer) for observer in ("0", "a"))
    turned = vanishes(from_0 - g.R_0a @ from_a)
    same_length = vanishes((g.R_0a @ g.r_ab) @ (g.R_0a @ g.r_ab) - g.r_ab @ g.r_ab)
    differ = not vanishes(from_0 - from_a)
    return Outcome(
        judge(holds=turned and same_length and differ),
        "Another observer turns the components, r from 0 is R times r from a, and keeps the length:"
        " no remainder. The two triples differ, so the observer may not be left out unless all"
        " vectors share it.",
    )


@computes("E-4")
def null_vector() -> Outcome:
    chain = general().chain
    null = [vanishes(chain.position(name, name, o)) for name in "ab" for o in ("0", "a", "b")]
    return Outcome(
        judge(holds=all(null)),
        f"Null for every rotation and vector, in all {len(null)} cases of frame and observer.",
    )


@computes("E-5")
def precedence() -> Outcome:
    names = ["a", "b", "c"]
    links = [Frame(n, p, UNTURNED, np.zeros(3)) for p, n in zip(["0", *names], names, strict=False)]
    chain = Frames("0", links)
    order = {pair for pair in permutations(names, 2) if chain.precedes(*pair)}
    itself = any(chain.precedes(name, name) for name in names)
    wanted = {("a", "b"), ("b", "c"), ("a", "c")}
    return Outcome(
        judge(holds=order == wanted and not itself),
        f"Of {len(list(permutations(names, 2)))} ordered pairs of a chain of three exactly"
        f" {len(order)} stand in the relation: it passes on from a to c, has no converse, and no"
        " frame precedes itself.",
    )


@computes("E-6")
def canonical_orientation() -> Outcome:
    chain = general().chain
    left = [vanishes(chain.rotation(name, name) - UNTURNED) for name in ("0", "a", "b")]
    return Outcome(
        judge(holds=all(left)),
        f"The rotation of a frame seen from itself is the identity for {len(left)} frames with"
        " general rotations: no remainder.",
    )


@computes("E-7")
def directional_cosines() -> Outcome:
    chain = general().chain
    axes_a, axes_b = chain.rotation("0", "a").T, chain.rotation("0", "b").T
    products = axes_a @ axes_b.T  # row: an axis of a; column: an axis of b
    unit = all(vanishes(axes[i] @ axes[i] - 1) for axes in (axes_a, axes_b) for i in range(3))
    return Outcome(
        judge(holds=vanishes(chain.rotation("a", "b") - products) and unit),
        f"All {products.size} entries of R are products of a unit vector of a and one of b, that is"
        " cosines of the angles between them, for every rotation.",
    )


@computes("E-8")
def unit_vector() -> Outcome:
    x, y, z = sp.symbols("x y z", real=True)
    r = np.array([x, y, z])
    u = sp.Matrix(paper.work_out(paper.UNIT_VECTOR, {"r": r, "x": x, "y": y, "z": z}))
    unit = sp.simplify(u.dot(u)) == 1
    parallel = u.cross(sp.Matrix(r)).applyfunc(sp.simplify) == sp.zeros(3, 1)
    limits = {sp.limit(u[0].subs({y: 0, z: 0}), x, 0, side) for side in "+-"}
    return Outcome(
        judge(holds=unit and parallel),
        "Length 1 and the direction of r, identically, where r is not null. At r = 0, where points"
        f" collide, there is none: along x the limits from the two sides are {max(limits)} and"
        f" {min(limits)}.",
    )
