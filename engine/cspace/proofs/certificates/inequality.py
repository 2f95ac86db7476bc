r"""The one inequality of certificates in doubles, over many leaves and things to keep at once.

The page "The certificate" defines it. A thing to keep is two convex hulls, the far one seen from
the frame of the near one, or one hull and a plane. Things with the same two frames make a `Kind`:
their places, slopes and bends are computed together, one row for each leaf and thing. Nothing here
is trusted, because the checker computes everything again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from cspace.arrays import Floats, Ints
from cspace.proofs.subdivide import Cells, Rows

SPARE = 1e-12
"""Part of an arm's length by which an inequality has to hold here: rounding takes less."""

REFINED = 4
"""Steps by which a direction is brought nearer to the best one."""

Table = dict[str, Any]


@dataclass(frozen=True, eq=False)
class ChainStep:
    """One turn or slide along the chain, with its mount: see "steps" on the page."""

    joint: int
    turns: bool
    factor: float
    origin: Floats
    mount: Floats
    axis: Floats
    reach: float
    sweep: float
    """Of a slide: the largest distance of its parent, and half of its range."""

    def turned(self, angle: Floats) -> Floats:
        """Return the rotation from the parent to its frame at angles, shape (T, 3, 3)."""
        one, two = np.sin(angle), 1 - np.cos(angle)
        across, twice = self._crosses
        return np.asarray(self.mount + one[:, None, None] * across + two[:, None, None] * twice)

    @cached_property
    def _crosses(self) -> tuple[Floats, Floats]:
        x, y, z = self.axis
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return self.mount @ cross, self.mount @ cross @ cross


@dataclass(frozen=True, eq=False)
class Kind:
    """Things to keep whose hulls have the same two frames, padded to equal numbers of corners.

    Attributes
    ----------
    things : ndarray of int, shape (G,)
        Numbers of the things in `keep`.
    near, far : int
        Frames.
    along : int or None
    places, corners : ndarray, shapes (G, m, 3) and (G, c, 3)
        Corners of the near hull and of the far hull, each in its frame. For a half-space the place
        is 0. Hulls of one or two corners are not padded.
    normals : ndarray, shape (G, 3), or None
        For half-spaces: unit normals.
    distances : ndarray, shape (G,)
        The required distances R, with the margin.
    """

    things: Ints
    near: int
    far: int
    along: int | None
    places: Floats
    corners: Floats
    normals: Floats | None
    distances: Floats


class BoundedArm:
    """An arm and its things to keep, in doubles, rad and lengths.

    Parameters
    ----------
    form : dict
        The normal form, see the page.
    margin : Fraction
    """

    def __init__(self, form: Mapping[str, Any], margin: Fraction = Fraction(0)) -> None:
        self.form = form
        self.angle = math.radians(1.0) if form["angle_unit"] == "deg" else 1.0
        self.units = np.array([self.angle if row["turns"] else 1.0 for row in form["joints"]])
        self.steps = [self._step(row) for row in form["steps"]]
        self.names = [str(row["name"]) for row in form["keep"]]
        self.asked = [Fraction(row["gap"]) + margin for row in form["keep"]]
        self.needed = [self._needed(k) for k in range(len(self.names))]
        self.kinds = list(self._kinds())
        self.kind_of = np.zeros(len(self.names), dtype=int)
        self.row_of = np.zeros(len(self.names), dtype=int)
        for number, kind in enumerate(self.kinds):
            self.kind_of[kind.things] = number
            self.row_of[kind.things] = np.arange(len(kind.things))
        self.size = sum(step.reach for step in self.steps) + max(
            (
                np.linalg.norm(np.concatenate([kind.corners, kind.places], axis=1), axis=2).max()
                + np.abs(kind.distances).max()
                for kind in self.kinds
            ),
            default=1.0,
        )
        self.spare = SPARE * self.size

    def _step(self, row: Table) -> ChainStep:
        joint, factor = self.form["joints"][row["joint"]], float(row["factor"])
        low, high = (0.0, 0.0) if joint["turns"] else map(float, joint["limits"])
        axis, origin = _numbers(row["axis"]), _numbers(row["origin"])
        return ChainStep(
            row["joint"],
            joint["turns"],
            factor,
            origin,
            _mount(_numbers(row["rpy"]) * self.angle),
            axis / np.linalg.norm(axis),
            float(np.linalg.norm(origin)) + max(abs(low), abs(high)),
            (high - low) / 2,
        )

    def _needed(self, k: int) -> bool:
        """Tell whether a thing needs trees; hulls without an inside are always at least 0 apart."""
        row, hulls = self.form["keep"][k], self.form["hulls"]
        if "normal" in row or self.asked[k]:
            return True
        return sum(len(hulls[row[end]]["corners"]) for end in ("near", "far")) > 3

    def _kinds(self) -> Iterator[Kind]:
        """Sort the things by their frames and, roughly, by how many corners they have."""
        hulls = [(row["frame"], _numbers(row["corners"])) for row in self.form["hulls"]]
        groups: dict[tuple[Any, ...], list[int]] = {}
        for k, row in enumerate(self.form["keep"]):
            frame, corners = hulls[row["far"]]
            near, places = (0, np.zeros((1, 3))) if "normal" in row else hulls[row["near"]]
            sizes = (_rounded_up(len(places)), _rounded_up(len(corners)))
            key = (near, frame, row.get("along"), "normal" in row, *sizes)
            groups.setdefault(key, []).append(k)
        for (near, far, along, plane, m, c), things in groups.items():
            rows = [self.form["keep"][k] for k in things]
            corners = np.array([_padded(hulls[row["far"]][1], c) for row in rows])
            places = np.array(
                [np.zeros((1, 3)) if plane else _padded(hulls[row["near"]][1], m) for row in rows]
            )
            normals = np.array([_numbers(row["normal"]) for row in rows]) if plane else None
            if normals is not None:
                normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            yield Kind(
                np.array(things),
                near,
                far,
                along,
                places,
                corners,
                normals,
                np.array([float(self.asked[k]) for k in things]),
            )

    def by_kind(self, things: Ints) -> Iterator[tuple[Kind, Ints, Ints]]:
        """Yield kinds, the positions of their things in a list, and these things' rows."""
        own = self.kind_of[things]
        for number in np.unique(own):
            positions = np.flatnonzero(own == number)
            yield self.kinds[number], positions, self.row_of[things[positions]]

    def seen(
        self,
        kind: Kind,
        rows: Ints,
        cells: Cells,
        corners: Floats | None = None,
        free: Sequence[bool] | None = None,
    ) -> Seen:
        """Return both hulls as seen from the near frame at the middles of cells.

        Parameters
        ----------
        rows : ndarray of int, shape (T,)
            Things of the kind, one for each cell.
        corners : ndarray, shape (T, c, 3), optional
            Places of the far frame; default the corners of the far hull.
        free : sequence of bool, optional
            Joints that may take any value.
        """
        corners = kind.corners[rows] if corners is None else corners
        steps = self.steps[kind.near : kind.far]
        r, axes, pivots = self._posed(kind, corners, cells.centres)
        reach = [abs(step.factor) * cells.reach[:, step.joint, None] for step in steps]
        spread, moves = np.zeros(r.shape[:2]), dict[int, Floats]()
        for k, step in reversed([*enumerate(steps)]):
            if free is None or not free[step.joint]:
                arm = r - pivots[k]
                moves[k] = _cross(axes[k], arm) if step.turns else np.broadcast_to(axes[k], r.shape)
            elif step.turns:  # the part across the axis may point anywhere
                foot = pivots[k] + _along(axes[k], r - pivots[k])
                spread = spread + np.linalg.norm(r - foot, axis=2)
                for i, move in moves.items():
                    spread += np.linalg.norm(move - _along(axes[k], move), axis=2) * reach[i]
                    moves[i] = _along(axes[k], move)
                r = foot
            else:
                spread = spread + step.sweep
        bend = _bend(r, steps, reach, moves)
        slopes = np.zeros((*cells.centres.shape, *r.shape[1:]))
        for k, move in moves.items():
            slopes[:, steps[k].joint] += steps[k].factor * move
        return _seen(kind, rows, r, slopes, bend, spread)

    def still(self, kind: Kind, rows: Ints, q: Floats) -> Seen:
        """Return both hulls seen from the near frame at configurations, (T, n), without motion."""
        r, *_ = self._posed(kind, kind.corners[rows], q)
        none = np.zeros(r.shape[:2])
        return _seen(kind, rows, r, np.zeros((len(q), 0, *r.shape[1:])), none, none)

    def _posed(
        self, kind: Kind, corners: Floats, q: Floats
    ) -> tuple[Floats, list[Floats], list[Floats]]:
        """Return places of the far frame, and the axes of all steps: directions and pivots."""
        at, turned = np.zeros((len(q), 3)), np.broadcast_to(np.eye(3), (len(q), 3, 3))
        axes, pivots = list[Floats](), list[Floats]()
        for step in self.steps[kind.near : kind.far]:
            at = at + turned @ step.origin
            axes.append((turned @ (step.mount @ step.axis))[:, None])
            pivots.append(at[:, None])
            value = step.factor * q[:, step.joint]
            if step.turns:
                turned = turned @ step.turned(value)
            else:
                at, turned = at + value[:, None] * axes[-1][:, 0], turned @ step.mount
        return at[:, None] + corners @ turned.transpose(0, 2, 1), axes, pivots


def _bend(
    r: Floats, steps: Sequence[ChainStep], reach: Sequence[Floats], moves: Mapping[int, Floats]
) -> Floats:
    """Return the bend of each corner, shape (T, c), from its slopes by the steps."""
    bend, turned = np.zeros(r.shape[:2]), np.zeros((len(r), 1))
    for k in sorted(moves):
        own = reach[k] * steps[k].turns
        bend += reach[k] * np.linalg.norm(moves[k], axis=2) * (turned + own / 2)
        turned = turned + own
    return bend


def _seen(kind: Kind, rows: Ints, r: Floats, slopes: Floats, bend: Floats, spread: Floats) -> Seen:
    """Join both hulls of things, and leave out the coordinate that does not count."""
    places = kind.places[rows]
    if kind.along is not None:
        for table in (places, r, slopes):  # copies all
            table[..., kind.along] = 0
    normals = None if kind.normals is None else kind.normals[rows]
    return Seen(places, r, slopes, bend, spread, kind.distances[rows], normals, kind.along)


@dataclass(frozen=True, eq=False)
class Seen(Rows):
    """Both hulls from the near frame at the middle of each leaf, T rows.

    Attributes
    ----------
    places : ndarray, shape (T, m, 3)
        Corners of the near hull.
    r : ndarray, shape (T, c, 3)
        Corners of the far hull.
    slopes : ndarray, shape (T, n, c, 3)
        Their derivatives by each joint.
    bend, spread : ndarray, shape (T, c)
        The bend, and how far joints that may take any value can move a corner.
    distances : ndarray, shape (T,)
    normals : ndarray, shape (T, 3), or None
    along : int or None
        The coordinate that is left out, where all places are 0.
    """

    places: Floats
    r: Floats
    slopes: Floats
    bend: Floats
    spread: Floats
    distances: Floats
    normals: Floats | None
    along: int | None

    def margins(self, u: Floats) -> Floats:
        """Return by how much the hulls are farther apart than asked at the middle, along u."""
        ahead = np.einsum("tcx,tx->tc", self.r, u).min(axis=1)
        return np.asarray(ahead - self._near(u) - self.distances)

    def kept(self, u: Floats, cells: Cells) -> Floats:
        """Return by how much the first inequality holds along unit vectors, shape (T, 3)."""
        ahead = np.einsum("tcx,tx->tc", self.r, u) - self.bend
        ahead += cells.least(np.einsum("tncx,tx->tnc", self.slopes, u))
        return np.asarray(ahead.min(axis=1) - self._near(u) - self.distances)

    def _near(self, u: Floats) -> Floats:
        return np.asarray(np.einsum("tmx,tx->tm", self.places, u).max(axis=1))

    def directions(self) -> Floats:
        """Return the unit vectors along which the hulls are farthest apart at the middle, (T, 3).

        For two points this is their difference; for hulls in the plane, the normal of an edge or
        the difference of two corners.
        """
        if self.normals is not None:
            return self.normals
        found = (self.r[:, None] - self.places[:, :, None]).reshape(len(self.r), -1, 3)
        if self.along is not None:
            edges = [np.roll(hull, -1, axis=1) - hull for hull in (self.places, self.r)]
            across = _cross(np.eye(3)[self.along], np.concatenate(edges, axis=1))
            found = np.concatenate([found, across, -across], axis=1)
        found = _units(found, 0 if self.along is None else self.along)
        ahead = np.einsum("tkx,tcx->tkc", found, self.r).min(axis=2)
        ahead -= np.einsum("tkx,tmx->tkm", found, self.places).max(axis=2)
        return np.asarray(found[np.arange(len(found)), ahead.argmax(axis=1)])

    def refined(self, cells: Cells) -> tuple[Floats, Floats]:
        """Return directions, shape (T, 3), and by how much the first inequality holds along them.

        To first order the differences of the hulls fill a convex set over a leaf. The point of this
        set nearest to 0 gives the best direction. Frank-Wolfe steps approach this point, until the
        inequality holds or even this point is too near.
        """
        u = self.directions()
        best, value = u.copy(), self.kept(u, cells)
        if self.normals is not None:
            return best, value
        left = np.flatnonzero(value <= 0)
        part, own, u = self[left], cells[left], u[left]
        nearest, _ = part.support(u, own)
        for _ in range(REFINED):
            step = part.support(u, own)[0] - nearest
            size = np.einsum("tx,tx->t", step, step)
            along = -np.einsum("tx,tx->t", step, nearest) / np.where(size > 0, size, 1)
            nearest = nearest + np.clip(along, 0, 1)[:, None] * step
            length = np.linalg.norm(nearest, axis=1)
            u = np.where(length[:, None] > 0, nearest / np.where(length, length, 1)[:, None], u)
            new = part.kept(u, own)
            better = new > value[left]
            value[left[better]], best[left[better]] = new[better], u[better]
            hope = length - part.bend.min(axis=1) - part.distances > 0
            more = (value[left] <= 0) & hope
            left, part, own, u, nearest = left[more], part[more], own[more], u[more], nearest[more]
            if not len(left):
                break
        return best, value

    def support(self, u: Floats, cells: Cells) -> tuple[Floats, Floats]:
        """Return the first-order difference of the hulls that is smallest along u, and its step.

        Shapes (T, 3) and (T, n).
        """
        rows = np.arange(len(u))
        slopes = np.einsum("tncx,tx->tnc", self.slopes, u)
        c = (np.einsum("tcx,tx->tc", self.r, u) + cells.least(slopes)).argmin(axis=1)
        m = np.einsum("tmx,tx->tm", self.places, u).argmax(axis=1)
        step = cells.lowest(slopes[rows, :, c])
        moved = np.einsum("tnx,tn->tx", self.slopes[rows, :, c], step)
        return self.r[rows, c] + moved - self.places[rows, m], step


# --- small things ---------------------------------------------------------------------------------


def _numbers(values: Any) -> Floats:
    """Read decimals."""
    return np.array(values, dtype=float)


def _mount(rpy: Floats) -> Floats:
    """Return the rotation of roll, pitch and yaw, rad."""
    (a, b, c), (d, e, f) = np.cos(rpy), np.sin(rpy)
    roll = np.array([[1, 0, 0], [0, a, -d], [0, d, a]])
    pitch = np.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
    yaw = np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])
    return np.asarray(yaw @ pitch @ roll)


def _rounded_up(count: int) -> int:
    """Return the least power of two that is not less than a number."""
    return 1 << (count - 1).bit_length()


def _padded(corners: Floats, count: int) -> Floats:
    """Repeat the last corner, which does not change the hull."""
    return np.concatenate([corners, np.repeat(corners[-1:], count - len(corners), axis=0)])


def _along(axis: Floats, v: Floats) -> Floats:
    """Return the part of vectors that is along a unit axis."""
    return np.asarray((axis * v).sum(axis=-1, keepdims=True) * axis)


def _cross(u: Floats, v: Floats) -> Floats:
    """Return the cross product, without the checks of NumPy's."""
    out = np.empty(np.broadcast_shapes(u.shape, v.shape))
    out[..., 0] = u[..., 1] * v[..., 2] - u[..., 2] * v[..., 1]
    out[..., 1] = u[..., 2] * v[..., 0] - u[..., 0] * v[..., 2]
    out[..., 2] = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return out


def _units(vectors: Floats, along: int) -> Floats:
    """Scale vectors to length 1; vectors of length 0 become the axis after a given one."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    safe = np.where(lengths > 0, vectors, np.eye(3)[(along + 1) % 3])
    return np.asarray(safe / np.where(lengths > 0, lengths, 1.0))
