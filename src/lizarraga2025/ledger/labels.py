"""Equations (1) to (8): labels of frames and vectors, in general rotations."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from lizarraga2025.ledger.entries import Finding, entry, judge
from lizarraga2025.ledger.proofs import UNTURNED, general, vanishes
from qbound.model.frames import Frame, Frames, axis_rotation

PAGE = "02_vector_labelling#equation-eq-"


@entry(
    "E-1",
    "equation",
    "eq. (1), rule 1 of Section 2",
    "A frame b seen from a frame a is a 3 by 4 matrix: three orthonormal columns and the vector"
    " to its origin.",
    test="test_frames.py::test_frame_is_the_relative_homogeneous_matrix",
    chapter=PAGE + "1",
)
def frame() -> Finding:
    g = general()
    o_ab = g.chain.frame("a", "b")
    columns = vanishes(o_ab[:, :3] - g.R_ab) and vanishes(o_ab[:, 3] - g.r_ab)
    orthonormal = vanishes(g.R_ab.T @ g.R_ab - UNTURNED)
    rows, width = o_ab.shape
    return Finding(
        judge(holds=columns and orthonormal and (rows, width) == (3, 4)),
        f"For every rotation and vector the library's frame is {rows} by {width}, its columns are"
        " those of R and r, and the transpose of R times R is the identity: no remainder.",
    )


@entry(
    "E-2",
    "equation",
    "eq. (2), rule 1 of Section 2",
    "A frame with one letter looks at itself: it is the canonical frame at its own origin.",
    test="test_frames.py::test_a_frame_stands_at_its_own_origin",
    chapter=PAGE + "2",
)
def frame_of_itself() -> Finding:
    chain = general().chain
    own = [chain.frame(name, name) - np.eye(3, 4, dtype=int) for name in ("a", "b")]
    return Finding(
        judge(holds=all(map(vanishes, own))),
        f"Computed, not set: {len(own)} frames with general rotations, seen from themselves, leave"
        " no remainder against [I 0].",
    )


@entry(
    "E-3",
    "equation",
    "eq. (3), rule 4 of Section 2",
    "A vector has a start a, an end b and an observer c that measures its components.",
    test="test_frames.py::test_observer_turns_a_vector_and_nothing_else",
    chapter=PAGE + "3",
)
def vector_and_observer() -> Finding:
    g = general()
    from_0, from_a = (g.chain.position("a+n", "b+m", observer) for observer in ("0", "a"))
    turned = vanishes(from_0 - g.R_0a @ from_a)
    same_length = vanishes((g.R_0a @ g.r_ab) @ (g.R_0a @ g.r_ab) - g.r_ab @ g.r_ab)
    differ = not vanishes(from_0 - from_a)
    return Finding(
        judge(holds=turned and same_length and differ),
        "Another observer turns the components, r from 0 is R times r from a, and keeps the length:"
        " no remainder. The two triples differ, so the observer may not be left out unless all"
        " vectors share it.",
    )


@entry(
    "E-4",
    "equation",
    "eq. (4), rule 4 of Section 2",
    "The vector from a frame to itself is null.",
    test="test_frames.py::test_a_frame_stands_at_its_own_origin",
    chapter=PAGE + "4",
)
def null_vector() -> Finding:
    chain = general().chain
    null = [vanishes(chain.position(name, name, o)) for name in "ab" for o in ("0", "a", "b")]
    return Finding(
        judge(holds=all(null)),
        f"Null for every rotation and vector, in all {len(null)} cases of frame and observer.",
    )


@entry(
    "E-5",
    "equation",
    "eq. (5), rule 6 of Section 2",
    "Frames of a chain are ordered: a precedes b and b precedes c.",
    test="test_frames.py::test_precedence_follows_the_parents",
    chapter=PAGE + "5",
)
def precedence() -> Finding:
    names = ["a", "b", "c"]
    links = [Frame(n, p, UNTURNED, np.zeros(3)) for p, n in zip(["0", *names], names, strict=False)]
    chain = Frames("0", links)
    order = {pair for pair in permutations(names, 2) if chain.precedes(*pair)}
    itself = any(chain.precedes(name, name) for name in names)
    wanted = {("a", "b"), ("b", "c"), ("a", "c")}
    return Finding(
        judge(holds=order == wanted and not itself),
        f"Of {len(list(permutations(names, 2)))} ordered pairs of a chain of three exactly"
        f" {len(order)} stand in the relation: it passes on from a to c, has no converse, and no"
        " frame precedes itself.",
    )


@entry(
    "E-6",
    "equation",
    "eq. (6), rule 9 of Section 2",
    "Seen from itself a frame has the canonical unit vectors.",
    test="test_frames.py::test_a_frame_stands_at_its_own_origin",
    chapter=PAGE + "6",
)
def canonical_orientation() -> Finding:
    chain = general().chain
    left = [vanishes(chain.rotation(name, name) - UNTURNED) for name in ("0", "a", "b")]
    return Finding(
        judge(holds=all(left)),
        f"The rotation of a frame seen from itself is the identity for {len(left)} frames with"
        " general rotations: no remainder.",
    )


@entry(
    "E-7",
    "equation",
    "eq. (7), rule 10 of Section 2",
    "The unit vectors of b seen from a are its directional cosines.",
    test="test_frames.py::test_columns_of_a_rotation_are_the_unit_vectors",
    chapter=PAGE + "7",
)
def directional_cosines() -> Finding:
    chain = general().chain
    axes_a, axes_b = chain.rotation("0", "a").T, chain.rotation("0", "b").T
    products = axes_a @ axes_b.T  # row: an axis of a; column: an axis of b
    unit = all(vanishes(axes[i] @ axes[i] - 1) for axes in (axes_a, axes_b) for i in range(3))
    return Finding(
        judge(holds=vanishes(chain.rotation("a", "b") - products) and unit),
        f"All {products.size} entries of R are products of a unit vector of a and one of b, that is"
        " cosines of the angles between them, for every rotation.",
    )


@entry(
    "E-8",
    "equation",
    "eq. (8), rule 11 of Section 2",
    "The unit vector of r is r divided by its length.",
    test="test_frames.py::test_unit_vector_is_the_direction",
    chapter="02_vector_labelling#unit-vectors",
    mended="u = r / |r| for two different origins.",
)
def unit_vector() -> Finding:
    import sympy as sp

    r = sp.Matrix(sp.symbols("x y z", real=True))
    length = sp.sqrt(r.dot(r))
    unit = sp.simplify((r / length).dot(r / length)) == 1
    parallel = (r / length).cross(r).applyfunc(sp.simplify) == sp.zeros(3, 1)
    limits = {sp.limit((r / length)[0].subs({r[1]: 0, r[2]: 0}), r[0], 0, s) for s in "+-"}
    return Finding(
        judge(holds=len(limits) == 1, under=unit and parallel),
        "Length 1 and the direction of r, identically, where r is not null. At r = 0, where points"
        f" collide, there is none: along x the limits from the two sides are {max(limits)} and"
        f" {min(limits)}.",
    )


def quarter_turn() -> Frames:
    """Return the smallest chain in which eqs. (15) and (25) differ: a turned, b one unit away."""
    turn = np.rint(axis_rotation([0, 1, 0], np.pi / 2)).astype(int)
    return Frames(
        "0",
        [
            Frame("a", "0", turn, np.zeros(3, int)),
            Frame("b", "a", UNTURNED, np.array([1, 0, 0])),
        ],
    )
