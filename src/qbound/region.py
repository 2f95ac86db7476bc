"""The feasible joint region: the box of the windows, cut by the half-spaces (Figures 4 and 5).

A region of two joints is a rectangle of joint values, the box, and the forms that must not be
negative in it, the cuts. Its corners are corners of the box, and roots of Theorem 2 along the sides
of the box, where a cut enters or leaves. Its area is an integral of lengths: on a line with one
joint held, a fibre, the region has pieces whose ends are roots of Theorem 2 too.

There are two kinds of region. `window_region` is the paper's: the box of Table 6, cut by the
half-spaces. `clearance_region` is that of all configurations at which the points keep their
distances: the joints' limits or one turn each, cut by pairs and half-spaces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound import polygon
from qbound.arrays import Bools, Floats
from qbound.boundary import clearance
from qbound.circle import first_from, nearest_turn, roots_along
from qbound.forms import HarmonicForm, stacked
from qbound.quadrature import Integral, integral
from qbound.robot import Robot
from qbound.windows import LOWER, UPPER, Bound, Box, window_box

ON_BOUNDARY: Final = 1e-12
"""A form this small, as part of its largest coefficient, is zero up to rounding."""

SAME_AREA: Final = 1e-9
"""Difference, as part of the area of the box, under which two computed areas are one."""


@dataclass(frozen=True, eq=False)
class Cut:
    """A form that is not negative in the region.

    Attributes
    ----------
    name : str
        Name of the boundary.
    component : int
        1, 2, 3 for x, y, z; 0 for a form that is not a component, such as a squared distance.
    form : HarmonicForm
        A single form of both joints.
    """

    name: str
    component: int
    form: HarmonicForm


@dataclass(frozen=True, eq=False)
class Corner:
    """A corner of the region: joint values q, shape (2,), and the two bounds that meet there."""

    q: Floats
    bounds: tuple[Bound, Bound]


@dataclass(frozen=True, eq=False)
class Edge:
    """A part of the region's boundary: from a corner to the next one, along their common bound."""

    start: Corner
    end: Corner
    bound: Bound


@dataclass(frozen=True, eq=False)
class Side:
    """A side of the box: from one corner of the box to the next, anticlockwise, and its bound."""

    start: Floats
    end: Floats
    bound: Bound


@dataclass(frozen=True, eq=False)
class Fibres:
    """Fibres of the region, which are lines on which one joint is held, cut into pieces.

    Attributes
    ----------
    start, end : ndarray, shape (m, k)
        Ends of the k pieces of each line, values of the other joint; some pieces have no length.
    inside : ndarray of bool, shape (m, k)
        Whether a piece lies in the region.
    """

    start: Floats
    end: Floats
    inside: Bools

    @property
    def length(self) -> Floats:
        """Length of each line inside the region, shape (m,)."""
        return np.asarray(((self.end - self.start) * self.inside).sum(axis=-1))


@dataclass(frozen=True, eq=False)
class Region:
    """The configurations of two joints that lie in a box and at which no cut is negative.

    Attributes
    ----------
    robot : Robot
        An arm of two joints.
    box : Box
        At most one turn wide along a joint that turns.
    cuts : tuple of Cut

    Examples
    --------
    >>> from qbound import load_robot, window_region
    >>> region = window_region(load_robot("minervabot-v2"))
    >>> len(region.corners), round(region.area, 3)
    (6, 11.754)
    """

    robot: Robot = field(repr=False)
    box: Box
    cuts: tuple[Cut, ...]

    def with_cut(self, name: str, form: HarmonicForm, component: int = 0) -> Region:
        """Return the part of the region at which one more form is not negative.

        Parameters
        ----------
        name : str
            Name of the boundary; no cut of the region has it yet.
        form : HarmonicForm
            A single form, such as `clearance`.
        component : int
            1, 2, 3 for x, y, z, for the label of the bound; 0 if the form is not a component.

        Examples
        --------
        Where the tool is also in front of x = 15 (``beta_{5,1}``):

        >>> from qbound import clearance, load_robot, window_region
        >>> robot = load_robot("minervabot-v2")
        >>> region = window_region(robot)
        >>> front = region.with_cut("B5", clearance(robot, robot.boundary("B5")), 1)
        >>> round(front.area / region.area, 6)
        0.401493
        """
        return replace(self, cuts=(*self.cuts, Cut(name, component, form)))

    @cached_property
    def forms(self) -> HarmonicForm:
        """The forms of all cuts, stack (m,)."""
        return stacked([cut.form for cut in self.cuts], self.robot.kinds)

    def contains(self, q: ArrayLike) -> Bools:
        """Tell which configurations, shape (..., 2), lie in the region or on its boundary.

        A point that was computed to lie on a cut, such as a corner, may lie on either side of the
        cut by rounding.

        Examples
        --------
        >>> from qbound import load_robot, window_region
        >>> region = window_region(load_robot("minervabot-v2"))
        >>> region.contains([[0.0, 0.0], [0.0, 1.0]]).tolist()
        [True, False]
        """
        return self.box.contains(q) & (self.forms(q) >= 0).all(axis=-1)

    # --- corners and edges

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """The edges, anticlockwise; each joins two neighbouring corners along their common bound.

        Raises
        ------
        ValueError
            If the region is empty. Or if a cut folds inside the box, so that its curve is not a
            function of q1, or meets another cut there: these corners are not on a side of the box.
            Area, centroid, fibres and `contains` do not need edges and hold for such a region too.
        """
        self._refuse_empty()
        sides = self._sides()
        corners: list[Corner] = []
        for i, side in enumerate(sides):
            corners += self._corners_on(side, sides[i - 1].bound)
        edges = []
        for start, end in zip(corners, [*corners[1:], *corners[:1]], strict=True):
            common = [bound for bound in start.bounds if bound in end.bounds]
            if len(common) == 2:  # a cut leaves the box through the side by which it entered
                side_is_inside = self.contains((start.q + end.q) / 2)
                common = common[:1] if side_is_inside else common[1:]
            edges += [Edge(start, end, bound) for bound in common]
        if not edges or len(edges) < len(corners) or not self._bounded_by(edges):
            raise ValueError(
                f"{self.robot.name}: a boundary function folds, or meets another one, inside the "
                "box; qbound names corners on the sides of the box, cspace names all; area, "
                "centroid, fibres and contains need no corners"
            )
        return tuple(edges)

    @property
    def corners(self) -> tuple[Corner, ...]:
        """The corners in closed form, anticlockwise (Figure 5); with the errors of `edges`.

        They are the corners of the box that no cut removes, and the points where a cut crosses a
        side of the box: Theorem 2 along that side.

        Examples
        --------
        The fourth point of Figure 5, and the two bounds that meet there:

        >>> from qbound import load_robot, window_region
        >>> corner = window_region(load_robot("minervabot-v2")).corners[3]
        >>> np.degrees(corner.q).round(2).tolist(), [bound.label for bound in corner.bounds]
        ([33.72, 44.38], ['beta_{3,3,1}', 'beta_{7,3,1}'])
        """
        return tuple(edge.start for edge in self.edges)

    @property
    def polygon(self) -> Floats:
        """The polygon through the corners, shape (m, 2), rad or length (Figure 5).

        Its straight edges replace the curves, so it is not the region. Errors are those of `edges`.

        Examples
        --------
        >>> from qbound import load_robot, window_region
        >>> np.degrees(window_region(load_robot("minervabot-v2")).polygon[3]).round(2).tolist()
        [33.72, 44.38]
        """
        return np.array([corner.q for corner in self.corners])

    @property
    def bounds(self) -> list[Bound]:
        """The bounds of the region, each once, in the order of its corners (Figure 4)."""
        bounds = [bound for corner in self.corners for bound in corner.bounds]
        return list(dict.fromkeys(bounds))  # a dict keeps the order

    def _refuse_empty(self) -> None:
        if self.area == 0:
            names = ", ".join(cut.name for cut in self.cuts)
            raise ValueError(f"{self.robot.name}: the region is empty: {names} cut the whole box")

    def _sides(self) -> list[Side]:
        """Return the sides of the box, anticlockwise: bottom, right, top, left; q1 to the right."""
        low, high = self.box.lower, self.box.upper
        (left, bottom), (right, top) = self.box.lower_bounds, self.box.upper_bounds
        low_high, high_low = np.array([low[0], high[1]]), np.array([high[0], low[1]])
        return [
            Side(low, high_low, bottom),
            Side(high_low, high, right),
            Side(high, low_high, top),
            Side(low_high, low, left),
        ]

    def _corners_on(self, side: Side, before: Bound) -> list[Corner]:
        """Return the corners on a side in its order: its start may be one, its end is not.

        The start of the side is also the end of the side before, whose bound is `before`.
        """
        joint = int(np.argmax(np.abs(side.end - side.start)))
        low, high = self.box.lower[joint], self.box.upper[joint]
        found = [Corner(side.start, (before, side.bound))]
        for cut in self.cuts:
            for root in self._into_box(joint, roots_along(cut.form, joint, side.start)).tolist():
                if low < root < high:
                    q = side.start.copy()
                    q[joint] = root
                    # Table 6 writes this bound as one of q2: an upper one where the form falls.
                    k = UPPER if cut.form.gradient(q)[1] < 0 else LOWER
                    found.append(Corner(q, (side.bound, Bound(cut.name, cut.component, k))))
        found.sort(key=lambda corner: float(np.abs(corner.q - side.start).max()))
        rounding = ON_BOUNDARY * np.abs(self.forms.coefficients).max(axis=(-1, -2))
        return [corner for corner in found if (self.forms(corner.q) >= -rounding).all()]

    def _bounded_by(self, edges: list[Edge]) -> bool:
        """Tell whether the edges bound the whole region: both have the same area."""
        inside = polygon.area([edge.start.q for edge in edges])
        for edge in edges:
            if self._cut(edge.bound):
                inside -= self._sliver(edge)
        box = float(np.prod(self.box.upper - self.box.lower))
        # A curve that ends on the way has a sliver of area NaN, and no comparison with NaN is true.
        return bool(abs(inside - self.area) <= SAME_AREA * box)

    # --- curves

    def curve(self, bound: Bound, q1: ArrayLike) -> Floats:
        """Return a cut's bound as q2 over q1: its root along the second joint (Table 6).

        Parameters
        ----------
        bound : Bound
            Its end k tells whether the form falls (`UPPER`) or rises (`LOWER`) along q2 there.
        q1 : array_like, shape (...)
            Values of the first joint, rad or length.

        Returns
        -------
        ndarray, shape (...)
            q2 in rad, not shifted into any turn, or length; NaN where there is no root.

        Raises
        ------
        ValueError
            If no cut has this bound.

        Examples
        --------
        ``beta_{7,3,1}`` at q1 = 60°:

        >>> from qbound import load_robot, window_region
        >>> from qbound.windows import UPPER, Bound
        >>> region = window_region(load_robot("minervabot-v2"))
        >>> np.degrees(region.curve(Bound("B7", 3, UPPER), np.radians([60.0]))).round(2).tolist()
        [-33.44]
        """
        cut = self._cut(bound)
        if cut is None:
            raise ValueError(f"{bound.label} is not a bound of a cut")
        q1 = np.asarray(q1, dtype=float)
        # The second column is not read: it stands for the joint that moves.
        rising, falling = roots_along(cut.form, 1, np.stack([q1, q1], axis=-1))
        return np.asarray(falling if bound.k == UPPER else rising)

    def with_points(self, n: int, *, tangents: bool) -> Floats:
        """Return a polygon with points on its curved sides (Section 4, the first remedy).

        Parameters
        ----------
        n : int
            Points of each curve, evenly spaced in q1, its ends included; 2 or more.
        tangents : bool
            Whether each curve is replaced by its tangents at these points, or by the chords
            between them.

        Returns
        -------
        ndarray, shape (m, 2)

        Raises
        ------
        ValueError
            As `edges`.

        Examples
        --------
        Five points on each of the two curves, ends included, are six points more:

        >>> from qbound import load_robot, window_region
        >>> region = window_region(load_robot("minervabot-v2"))
        >>> len(region.polygon), len(region.with_points(5, tangents=False))
        (6, 12)
        """
        found = []
        for edge in self.edges:
            found.append(edge.start.q)
            cut = self._cut(edge.bound)
            if cut:
                q = self._along_curve(edge, np.linspace(0, 1, n))
                normal = cut.form.gradient(q)
                found += list(polygon.tangent_corners(q, normal) if tangents else q[1:-1])
        return np.array(found)

    def _cut(self, bound: Bound) -> Cut | None:
        """Return the cut that has a bound; None for a side of the box."""
        for cut in self.cuts:
            if (cut.name, cut.component) == (bound.boundary, bound.component):
                return cut
        return None

    def _along_curve(self, edge: Edge, t: Floats) -> Floats:
        """Return points of a curved edge over the points t of its chord, 0 to 1: shape (m, 2)."""
        chord = edge.start.q + t[:, None] * (edge.end.q - edge.start.q)
        q2 = self.curve(edge.bound, chord[:, 0])
        if self.robot.joints[1].turns:
            q2 = nearest_turn(q2, chord[:, 1])
        return np.stack([chord[:, 0], q2], axis=-1)

    def _above_chord(self, edge: Edge, t: Floats) -> Floats:
        """Return the integrand of a sliver's area: (q2 of the curve - q2 of the chord) dq1 / dt.

        A sliver is the part between a curved edge and its chord.
        """
        chord = edge.start.q[1] + t * (edge.end.q - edge.start.q)[1]
        above = self._along_curve(edge, t)[:, 1] - chord
        return np.asarray(above * (edge.end.q - edge.start.q)[0])

    def _sliver(self, edge: Edge) -> float:
        """Return the area of a sliver, positive if the edge runs to the right above its chord."""
        if np.isnan(self.curve(edge.bound, np.linspace(edge.start.q[0], edge.end.q[0], 99))).any():
            return np.nan  # the curve turns back on the way
        return float(integral(lambda t: self._above_chord(edge, t), 0.0, 1.0).value)

    def area_by_nodes(self, nodes: int) -> float:
        """Return the area as the polygon less the slivers at its curves, by Gauss's rule.

        This is a closed form with few solutions of Theorem 2; `area` takes as many as it needs.

        Parameters
        ----------
        nodes : int
            Nodes of Gauss's rule on each curve; each is one solution of Theorem 2.

        Raises
        ------
        ValueError
            As `edges`.

        Examples
        --------
        >>> from qbound import load_robot, window_region
        >>> region = window_region(load_robot("minervabot-v2"))
        >>> round(region.area_by_nodes(40) - region.area, 9)
        0.0
        """
        x, weights = np.polynomial.legendre.leggauss(nodes)
        found = polygon.area(self.polygon)
        for edge in self.edges:
            if self._cut(edge.bound):
                found -= float(weights @ self._above_chord(edge, (x + 1) / 2)) / 2
        return found

    # --- area and centroid

    @property
    def area(self) -> float:
        """The area, which is the integral of the lengths of the fibres over q1.

        In rad² for two joints that turn, in rad times length if one slides. 0 if the region is
        empty.
        """
        return float(self._moments.value[0])

    @property
    def area_error(self) -> float:
        """Bound of the numerical error of `area`, in its unit."""
        return float(self._moments.error[0])

    @property
    def centroid(self) -> Floats:
        """The centroid of the area, shape (2,), rad or length.

        It is that of the region between the curves. The polygon through the corners has another
        one, `qbound.polygon.centroid`, about which Figure 6 scales.

        Raises
        ------
        ValueError
            If the region is empty.
        """
        self._refuse_empty()
        return np.asarray(self._moments.value[1:] / self.area)

    @property
    def centroid_error(self) -> Floats:
        """Bound of the numerical error of `centroid`, shape (2,)."""
        error = self._moments.error
        return np.asarray((error[1:] + np.abs(self.centroid) * error[0]) / self.area)

    @cached_property
    def _moments(self) -> Integral:
        """Integrals of 1, q1 and q2 over the region, which are area and first moments."""

        def of_fibres(q1: Floats) -> Floats:
            fibres = self.fibres(0, q1)
            # The integral of q2 along a piece.
            second = ((fibres.end**2 - fibres.start**2) / 2 * fibres.inside).sum(axis=-1)
            return np.stack([fibres.length, q1 * fibres.length, second], axis=-1)

        return integral(of_fibres, self.box.lower[0], self.box.upper[0])

    def fibres(self, held: int, values: ArrayLike) -> Fibres:
        """Cut lines on which one joint is held at the roots of Theorem 2, into pieces.

        Parameters
        ----------
        held : int
            Number of the joint that is held, 0 or 1.
        values : array_like, shape (m,)
            Its values, rad or length, one for each line.

        Raises
        ------
        ValueError
            If `held` is neither 0 nor 1.

        Examples
        --------
        At q1 = 60° the tool's limit leaves q2 from the lower side of the box to -33.44°:

        >>> from qbound import load_robot, window_region
        >>> region = window_region(load_robot("minervabot-v2"))
        >>> fibre = region.fibres(0, np.radians([60.0]))
        >>> np.degrees(fibre.start[fibre.inside]).round(2).tolist()
        [-162.3]
        >>> np.degrees(fibre.end[fibre.inside]).round(2).tolist()
        [-33.44]
        """
        if held not in (0, 1):
            raise ValueError(f"the joints of a region have the numbers 0 and 1, found {held}")
        values, free = np.asarray(values, dtype=float), 1 - held
        low, high = self.box.lower[free], self.box.upper[free]
        lines = np.stack([values, values], axis=-1)
        rising, falling = self._into_box(free, roots_along(self.forms, free, lines))
        sides = np.broadcast_to([low, high], (len(values), 2))
        ends = np.sort(np.concatenate([sides, rising, falling], axis=-1), axis=-1)
        start, end = ends[:, :-1], ends[:, 1:]
        # No cut changes its sign within a piece, so the middle of a piece decides for all of it.
        middle = np.empty((*start.shape, 2))
        middle[..., held], middle[..., free] = values[:, None], (start + end) / 2
        return Fibres(start, end, self.contains(middle))

    def _into_box(self, joint: int, roots: Floats) -> Floats:
        """Shift roots along a joint by full turns into the box.

        A root that has no such turn, or is NaN, becomes a side of the box, where it cuts nothing.
        """
        low, high = self.box.lower[joint], self.box.upper[joint]
        if self.robot.joints[joint].turns:
            roots = first_from(low, roots)  # the box is at most a turn wide
        return np.clip(np.where(np.isnan(roots), low, roots), low, high)


def window_region(robot: Robot) -> Region:
    """Return the region of the paper: the box of the windows, cut by the half-spaces in use.

    The windows depend on the home pose and not on the clearances of the pairs (Table 6).

    Raises
    ------
    ValueError
        If the arm does not have two joints. As `windows.window_box`: if a pair does not have one
        joint between its points, or if nothing bounds a joint.

    Examples
    --------
    >>> from qbound import load_robot, window_region
    >>> region = window_region(load_robot("minervabot-v2"))
    >>> len(region.corners), round(region.area, 6)
    (6, 11.754495)
    """
    _refuse_more_joints(robot)
    cuts = []
    for boundary in robot.used_half_spaces:
        # For its label an oblique half-space is a bound of the largest component of its normal.
        component = int(np.argmax(np.abs(boundary.normal))) + 1
        cuts.append(Cut(boundary.name, component, clearance(robot, boundary)))
    return Region(robot, window_box(robot), tuple(cuts))


def clearance_region(robot: Robot, names: Sequence[str] | None = None) -> Region:
    """Return the region of the distances: limits or one turn a joint, cut by clearances (eq. 11).

    It has all configurations that respect the boundaries in use: `boundary.keeps_clear`. Such a
    region may have several parts, reachable from home or not. Its corners are often not on the
    sides of the box; then `Region.corners` refuses.

    Parameters
    ----------
    names : sequence of str, optional
        Names of the boundaries that cut, such as ``["B7"]``; default: all in use.

    Raises
    ------
    ValueError
        If the arm does not have two joints, a joint slides without limits, or a name is unknown.

    Examples
    --------
    All joint values of a turn at which the tool is above its limit:

    >>> from qbound import clearance_region, load_robot
    >>> round(clearance_region(load_robot("minervabot-v2"), ["B7"]).area, 4)
    26.0665
    """
    _refuse_more_joints(robot)
    boundaries = robot.used if names is None else [robot.boundary(name) for name in names]
    box = Box(
        lower=np.array([joint.range[0] for joint in robot.joints]),
        upper=np.array([joint.range[1] for joint in robot.joints]),
        lower_bounds=tuple(Bound(joint.name, 0, LOWER) for joint in robot.joints),
        upper_bounds=tuple(Bound(joint.name, 0, UPPER) for joint in robot.joints),
    )
    cuts = (Cut(b.name, 0, clearance(robot, b)) for b in boundaries)
    return Region(robot, box, tuple(cuts))


def _refuse_more_joints(robot: Robot) -> None:
    if len(robot.joints) != 2:
        raise ValueError(
            f"{robot.name} has {len(robot.joints)} joints, and qbound handles regions of two; "
            "cspace handles slices of more"
        )
