"""From marching cubes to a mesh whose triangles lie each on one boundary function.

A vertex is put onto the function that is active where it stands; where another one is then
violated, onto both, or three. An edge of the mesh whose ends lie on different functions is cut
where the two meet, and a triangle of three functions in their corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import combinations
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from qbound.arms.surface_forms import BLOCK, ON_FORM, TIED, SurfaceForms
from qbound.arrays import Bools, Floats

Ints = NDArray[np.intp]

MOST: Final = 3
"""Functions that meet in a corner of three joints; more only by chance."""

VIOLATED: Final = 4 * ON_FORM
"""A function, by its size, that is less than minus this is violated; above, it may vanish."""

CUTS: Final = 3
"""Rounds of cutting: between two functions a third may come up."""

FAR: Final = 10.0
"""Steps that no place is moved by."""

WELDED: Final = 9
"""Digits of a step in which the places of one vertex agree."""

NONE: Final = -1
"""Stands for a function in a set that has fewer."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in space.

    Attributes
    ----------
    vertices : ndarray, shape (v, 3)
    triangles : ndarray of int, shape (t, 3)
    active : ndarray of int, shape (t,)
        The function that each triangle lies on.
    exact : ndarray of bool, shape (v,)
        Whether a vertex is on a function that is active there.
    held : ndarray of bool, shape (v, 3)
        Coordinates of vertices on the border of the grid, which stay there.
    nearest : ndarray of int, shape (v,)
        The function that the search for a vertex begins with.
    """

    vertices: Floats
    triangles: Ints
    active: Ints
    exact: Bools
    held: Bools
    nearest: Ints

    @classmethod
    def empty(cls) -> Self:
        """Return the mesh of no triangles."""
        none, number = np.empty((0, 3)), np.empty(0, dtype=np.intp)
        return cls(none, none.astype(np.intp), number, number == 0, none == 0, number)


@dataclass(frozen=True, eq=False)
class Placed:
    """Vertices on their functions.

    Attributes
    ----------
    vertices : ndarray, shape (v, 3)
    sets : ndarray of int, shape (v, MOST)
        The functions of each, ascending in the order they were met; `NONE` beyond.
    exact : ndarray of bool, shape (v,)
    held : ndarray of bool, shape (v, 3)
        As in `Mesh`.
    """

    vertices: Floats
    sets: Ints
    exact: Bools
    held: Bools

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Return all of several, one after the other."""
        columns = [[getattr(part, each.name) for part in parts] for each in fields(cls)]
        return cls(*map(np.concatenate, columns))


def refined(forms: SurfaceForms, mesh: Mesh, step: Floats) -> Mesh:
    """Put a mesh onto its functions, and cut it where they meet.

    Parameters
    ----------
    step : ndarray, shape (3,)
        Of the grid.
    """
    placed = _onto_active(forms, mesh.vertices, mesh.nearest[:, None], mesh.held, step)
    triangles, before = mesh.triangles, 0
    for _ in range(CUTS):
        triangles, placed, before = *_cut(forms, triangles, placed, step), len(triangles)
        if len(triangles) == before:
            break
    number, kept = _welded(placed.vertices / step)
    triangles = number[triangles]
    real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    vertices, triangles = placed.vertices[kept], triangles[real]
    return replace(
        mesh,
        vertices=vertices,
        triangles=triangles,
        active=_labels(forms, vertices, triangles, placed.sets[kept]),
        exact=placed.exact[kept],
        held=placed.held[kept],
        nearest=placed.sets[kept, 0],
    )


def _welded(places: Floats) -> tuple[Ints, Ints]:
    """Return numbers under which equal places are one, and the places that stand for them."""
    _, kept, number = np.unique(
        places.round(WELDED), axis=0, return_index=True, return_inverse=True
    )
    return number.ravel(), kept


def _cut(forms: SurfaceForms, triangles: Ints, placed: Placed, step: Floats) -> tuple[Ints, Placed]:
    """Cut edges whose ends have no function in common, and triangles whose corners have none."""
    edges, of_triangle = _edges(triangles)
    one, other = placed.sets[edges[:, 0]], placed.sets[edges[:, 1]]
    cut = ~_shares(one, other)
    ends = edges[cut]
    on_edges = _onto_active(
        forms,
        placed.vertices[ends].mean(axis=1),
        np.column_stack([one[cut, 0], other[cut, 0]]),
        np.asarray(placed.held[ends].all(axis=1)),
        step,
    )
    number = np.full(len(edges), NONE, dtype=np.intp)
    number[cut] = len(placed.vertices) + np.arange(len(ends))
    cuts = number[of_triangle]  # (t, 3): the vertex on the edge after each corner
    missing = (cuts != NONE).sum(axis=1)
    in_three = (missing == 3) | ((missing == 0) & ~_common(placed.sets[triangles]).any(axis=1))
    corners = triangles[in_three]
    in_corners = _onto_active(
        forms,
        placed.vertices[corners].mean(axis=1),
        _three(placed.sets[corners]),
        np.asarray(placed.held[corners].all(axis=1)),
        step,
    )
    centre = np.full(len(triangles), NONE, dtype=np.intp)
    centre[in_three] = len(placed.vertices) + len(ends) + np.arange(len(corners))
    return _divided(triangles, cuts, centre), Placed.joined((placed, on_edges, in_corners))


def _three(sets: Ints) -> Ints:
    """Return three functions of the corners of triangles, shape (k, 3, MOST) to (k, MOST)."""
    rows = [list(dict.fromkeys(row.T[row.T != NONE].tolist()))[:MOST] for row in sets]
    padded = [row + [NONE] * (MOST - len(row)) for row in rows]
    return np.array(padded, dtype=np.intp).reshape(-1, MOST)


def _onto_active(
    forms: SurfaceForms, start: Floats, wanted: Ints, held: Bools, step: Floats
) -> Placed:
    """Put places onto wanted functions; where another is then violated, onto that one, too.

    Where these do not meet a place goes onto some of them: a strip of a third function may lie
    between two, narrower than a step. Where that fails as well, it stays.
    """
    count = len(start)
    sets = np.full((count, MOST), NONE, dtype=np.intp)
    sets[:, : wanted.shape[1]] = wanted
    vertices, exact = start.copy(), np.zeros(count, dtype=np.bool_)
    violated = np.full(count, NONE, dtype=np.intp)
    left = np.arange(count)
    for _ in range(MOST + 1):
        place, found = _by_size(forms, start[left], sets[left], held[left], step)
        which, least = forms.least(place)
        safe = least >= -VIOLATED
        done = found & safe
        vertices[left[done]], exact[left[done]] = place[done], True
        violated[left] = which
        full = sets[left, MOST - 1] != NONE
        more = found & ~safe & ~full & ~(sets[left] == which[:, None]).any(axis=1)
        left, which = left[more], which[more]
        sets[left, (sets[left] != NONE).sum(axis=1)] = which
    rest = np.flatnonzero(~exact)
    active, _ = forms.least(start[rest])
    known = np.column_stack([violated[rest], active, sets[rest]])
    vertices[rest], sets[rest], exact[rest] = _onto_some(
        forms, start[rest], known, held[rest], step
    )
    return Placed(vertices, sets, exact, held)


def _onto_some(
    forms: SurfaceForms, start: Floats, known: Ints, held: Bools, step: Floats
) -> tuple[Floats, Ints, Bools]:
    """Put places onto those of some functions where nothing is violated.

    The nearest such place counts, of equally near ones the first, and one on the first function
    before one on others: it is what lies between them.

    Parameters
    ----------
    known : ndarray of int, shape (N, k)
        The functions to choose from; a place for which none will do stays, with the second.
    """
    best = np.full(len(start), np.inf)
    place, sets = start.copy(), np.full((len(start), MOST), NONE, dtype=np.intp)
    sets[:, 0] = known[:, 1]
    repeated = [(known[:, :k] == known[:, [k]]).any(axis=1) for k in range(known.shape[1])]
    usable = (known != NONE) & ~np.column_stack(repeated)
    for size in range(1, MOST + 1):
        for chosen in map(list, combinations(range(known.shape[1]), size)):
            here = np.flatnonzero(usable[:, chosen].all(axis=1))
            wanted = known[here][:, chosen]
            moved, found = forms.onto(start[here], wanted, held[here], step)
            away = np.linalg.norm((moved - start[here]) / step, axis=1) + FAR * (0 not in chosen)
            better = found & (away < best[here] - TIED)
            better[better] = forms.least(moved[better])[1] >= -VIOLATED
            at = here[better]
            best[at], place[at], sets[at, :size] = away[better], moved[better], wanted[better]
            sets[at, size:] = NONE
    return place, sets, np.isfinite(best)


def _by_size(
    forms: SurfaceForms, start: Floats, sets: Ints, held: Bools, step: Floats
) -> tuple[Floats, Bools]:
    """Put places onto the functions of their sets, those of one size together."""
    place, found = start.copy(), np.zeros(len(start), dtype=np.bool_)
    sizes = (sets != NONE).sum(axis=1)
    for size in range(1, MOST + 1):
        here = np.flatnonzero(sizes == size)
        for part in np.split(here, range(BLOCK, len(here), BLOCK)):
            moved = forms.onto(start[part], sets[part, :size], held[part], step)
            place[part], found[part] = moved
    return place, found


def _edges(triangles: Ints) -> tuple[Ints, Ints]:
    """Return the edges of a mesh, (e, 2), and those after each corner of a triangle, (t, 3)."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges, number = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    return edges, number.reshape(-1, 3)


def _shares(one: Ints, other: Ints) -> Bools:
    """Tell which sets have a function in common."""
    same = (one[:, :, None] == other[:, None, :]) & (one[:, :, None] != NONE)
    return np.asarray(same.any(axis=(1, 2)))


def _divided(triangles: Ints, cuts: Ints, centre: Ints) -> Ints:
    """Divide triangles along cuts of their edges; those of three cuts about a centre.

    The way round stays.
    """
    parts = []
    for count in range(4):
        here = (cuts != NONE).sum(axis=1) == count
        corner, on = triangles[here], cuts[here]
        if count in (1, 2):  # turn it so that the cuts begin with the first edge
            first = (on != NONE) & ((count == 1) | (np.roll(on, -1, axis=1) != NONE))
            turn = (np.arange(3) + first.argmax(axis=1)[:, None]) % 3
            corner, on = (np.take_along_axis(x, turn, axis=1) for x in (corner, on))
        (a, b, c), (ab, bc, ca), m = corner.T, on.T, centre[here]
        parts += {
            0: [(a[m == NONE], b[m == NONE], c[m == NONE]), *_about(a, b, c, m)],
            1: [(a, ab, c), (ab, b, c)],
            2: [(ab, b, bc), (a, ab, bc), (a, bc, c)],
            3: [(a, ab, m), (ab, b, m), (b, bc, m), (bc, c, m), (c, ca, m), (ca, a, m)],
        }[count]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def _about(a: Ints, b: Ints, c: Ints, m: Ints) -> list[tuple[Ints, Ints, Ints]]:
    """Divide triangles that have a centre about it."""
    a, b, c, m = (x[m != NONE] for x in (a, b, c, m))
    return [(a, b, m), (b, c, m), (c, a, m)]


def _common(sets: Ints) -> Bools:
    """Tell which functions of their first corners all corners of triangles have, (t, MOST)."""
    one, *others = (sets[:, k] for k in range(3))
    found = one != NONE
    for other in others:
        found = found & (one[:, :, None] == other[:, None]).any(axis=2)
    return np.asarray(found)


def _labels(forms: SurfaceForms, vertices: Floats, triangles: Ints, sets: Ints) -> Ints:
    """Return the function that all corners of a triangle have, else the active one inside."""
    common = _common(sets[triangles])
    labels = sets[triangles[:, 0]][np.arange(len(triangles)), common.argmax(axis=1)]
    unclear = np.flatnonzero(common.sum(axis=1) != 1)
    labels[unclear] = forms.least(vertices[triangles[unclear]].mean(axis=1))[0]
    return np.asarray(labels)
