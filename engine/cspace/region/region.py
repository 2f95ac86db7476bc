"""The feasible region of two joints, complete: components, labelled arcs, vertices, measures."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arguments import refuse_type, whole_number
from cspace.arrays import Bools, Floats, Ints, ranges
from cspace.model.robot import Held, Joint, Robot, real_numbers, refuse_no_robot
from cspace.printable import printable
from cspace.region.cells import (
    CellComplex,
    apart,
    decompose,
    find_cells,
    nothing_in,
    turned_root,
)
from cspace.region.events import INSIDE, find_events
from cspace.region.outline import Component, closures, drawn, numbered, ordered, outlined
from cspace.region.plane import LEVELS, Precise, UndecidedError, flint, precision, which
from cspace.region.problem import Problem, clearance_problem
from cspace.tolerances import ON_ARC, UNIT
from cspace.units import limited_joints, margin_text
from qbound.circle import TURN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from shapely import MultiPolygon

    from cspace.measures.nearest import BoundaryPoint

CAUTION = (1.0, 2.0**12)
"""By how much errors of doubles are overestimated: at first, and where a region was not right."""

TRIED = 1000
"""Random places at the start."""


def irreducible(problem: Problem, base: int) -> tuple[str, ...]:
    """Return boundaries that together leave no feasible place, but would if any one were dropped.

    Parameters
    ----------
    problem : Problem
        A problem with an empty region, without forms that depend on neither joint.
    base : int
        Which joint is the base of the cells.

    Returns
    -------
    tuple of str
        Empty if no boundary is the cause, because a range has no width.
    """
    names = _names(problem)
    if not len(names):
        return ()  # a range has no width
    rows = _violated(problem, _random_places(problem))
    rows = rows[rows.any(axis=1)]
    while True:
        chosen = _greedy_cover(rows)
        place = _free_place(_only(problem, names[chosen]), base)
        if place is None:
            break
        # The chosen boundaries are free there, although doubles may show contact.
        row = _violated(problem, place[None]) & ~chosen
        if not row.any():  # too near to contact: only the cells of all boundaries decide
            chosen[:] = True
            break
        rows = np.concatenate([rows, row])
    for k in np.flatnonzero(chosen).tolist():
        without = chosen & (np.arange(len(chosen)) != k)
        needed = (~rows[:, without].any(axis=1)).any()
        if not needed and _free_place(_only(problem, names[without]), base) is None:
            chosen = without
    return tuple(names[chosen].tolist())


def _names(problem: Problem) -> NDArray[np.object_]:
    """Return the names of all boundaries, forms first."""
    return np.array([*problem.names, *(body.name for body in problem.bodies)], dtype=object)


def _random_places(problem: Problem) -> Floats:
    ends = np.array([(-np.pi, np.pi) if r is None else r for r in problem.ranges])
    return np.random.default_rng(0).uniform(ends[:, 0], ends[:, 1], (TRIED, 2))


def _violated(problem: Problem, q: Floats) -> Bools:
    """Tell which boundaries are violated at places, or touch, shape (n, boundaries)."""
    found = dict(zip(problem.evaluator.names, problem.evaluator.margins(q).T, strict=True))
    return np.stack([found[name] <= 0 for name in _names(problem)], axis=-1)


def _greedy_cover(rows: Bools) -> Bools:
    """Choose columns so that each row has one: each time the column that most open rows have."""
    chosen, left = np.zeros(rows.shape[1], dtype=np.bool_), rows
    while len(left):
        best = int(left.sum(axis=0).argmax())
        chosen[best], left = True, left[~left[:, best]]
    return chosen


def _only(problem: Problem, kept: Iterable[str]) -> Problem:
    """Return the problem with some of its boundaries."""
    wanted = set(kept)
    problem = problem.without([k for k, name in enumerate(problem.names) if name not in wanted])
    return problem.without_bodies([b.name for b in problem.bodies if b.name not in wanted])


def _free_place(problem: Problem, base: int) -> Floats | None:
    """Return a place inside a cell, not in the middle; None if there is no cell."""
    precise = Precise.of(problem, base)
    found = decompose(precise)
    if not len(found.slabs):
        return None
    # The first of the cells over the widest slab.
    k = int(np.diff(found.lines)[found.slabs].argmax())
    start, end = found.lines[found.slabs[k] + np.array([0, 1])]
    t = start + INSIDE * (end - start)
    low, high = precise.plane.follow(found.roots[k], np.array([[t], [t]]))[:, 0]
    return ordered(np.array([t, low + INSIDE * (high - low)]), base)


class UnresolvedError(ValueError):
    """Error: the structure of a region could not be decided; the message says where and why."""


class NoHomeError(ValueError):
    """Error: the home pose is in no component; the message says which boundary it violates."""


@dataclass(frozen=True, eq=False)
class Region:
    """The feasible region of two joints: components, labelled arcs, vertices, measures.

    A configuration is feasible where no margin is negative, up to rounding; it belongs to the
    components in whose closure it lies. A configuration that touches and has no free neighbourhood
    is feasible but in no component. Feasible means what the boundaries of the file look at: its
    points, or whole bodies (`Robot.feasible_by`).

    Attributes
    ----------
    outlined : tuple of Component
        The components, unless the region is unresolved.
    problem : Problem
        The question: robot, joints, held values, forms.
    inner : Problem
        The part of the problem that was searched: forms that some joint moves and that matter.
    cells : CellComplex
        The cells of the components.
    base : int
        Which joint is the base of the cells.
    owner : dict of int to int
        Component of each cell.
    irrelevant : tuple of str
        Boundaries that were proved to bound nothing here (`relevant_forms`) and took no part in the
        search; `margins` and `contains` still use them.
    unresolved : tuple of str
        Where and why the region did not pass its own check: 1,024 bits do not decide its structure,
        or areas found over the two joints differ; mostly empty. Otherwise `components`, and
        everything that needs them, raise `UnresolvedError`; `contains` and `margins` still work.

    Notes
    -----
    A region is returned only after it has checked itself (`faults`).

    Components, loops and vertices are decided exactly, from the decimals of the robot file. Places
    are doubles: within 1e-12 of the arm's size where curves cross (`Vertex.error`), 1e-6 where they
    touch, and within 1e-7 of the size about anything smaller than that.

    Examples
    --------
    >>> import numpy as np
    >>> from cspace import find_region, load_robot
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> [round(component.area, 3) for component in region.components]
    [11.78, 8.552, 4.212, 0.65, 0.649]
    >>> vertex = region.home_component.vertices[0]
    >>> vertex.boundaries, np.degrees(vertex.q).round(2).tolist()
    (('B7', 'B4'), [-93.81, -163.81])

    `has_home` is False where the home pose is in no component, and `home_component` raises an error
    that says why.
    """

    outlined: tuple[Component, ...]
    problem: Problem
    inner: Problem
    cells: CellComplex
    base: int
    owner: dict[int, int]
    irrelevant: tuple[str, ...] = field(default_factory=tuple)
    unresolved: tuple[str, ...] = field(default_factory=tuple)

    def __eq__(self, other: object) -> bool:
        """Tell whether two regions are of equal problems and have the same structure.

        Equal robots may be written in decimals that doubles do not tell apart, but regions do.
        """
        if not isinstance(other, Region):
            return NotImplemented
        return self.problem == other.problem and _counts(self) == _counts(other)

    def __hash__(self) -> int:
        """Return a number that equal regions share."""
        return hash(self.problem)

    def __repr__(self) -> str:
        """Show the robot, the number of components and the area on one line."""
        robot = self.problem.robot
        of = f" of {printable(robot.name)}" if robot is not None else ""
        if self.unresolved:
            return f"<Region{of}: unresolved: {printable(self.unresolved[0])}>"
        count = f"{len(self.components)} component{'s' * (len(self.components) != 1)}"
        home = "" if robot is None else ", with home" if self.has_home else ", home in none"
        return f"<Region{of}: {count}{home}, area {self.area:.6g} {self.area_unit}>"

    @cached_property
    def empty_because(self) -> tuple[str, ...]:
        """Where there is no component: boundaries that leave no room together, each of them needed.

        Found when first asked for, because that can take longer than the region. Where some part of
        the search cannot be decided, all boundaries are named.
        """
        if self.outlined or self.unresolved:
            return ()
        try:
            return self.problem.blocked[:1] or irreducible(self.inner, self.base)
        except UndecidedError:
            return tuple(_names(self.inner).tolist())

    @property
    def components(self) -> tuple[Component, ...]:
        """All components, the one with the home pose first, the others by falling area.

        Components of equal area come by their centroids' joint values, lower ones first
        (`cspace.region.outline.in_canonical_order`).

        Raises
        ------
        UnresolvedError
            If the structure could not be decided.
        """
        if self.unresolved:
            raise UnresolvedError(f"this region is unresolved: {'; '.join(self.unresolved)}")
        return self.outlined

    @property
    def limited(self) -> dict[str, Joint]:
        """The joint of each limit; ends of windows bear the names of boundaries."""
        joints, problem = self.robot.joints, self.problem
        windows = zip(problem.joints, problem.limits, strict=True)
        return limited_joints(self.robot) | {n: joints[j] for j, ends in windows for n in ends}

    @property
    def has_home(self) -> bool:
        """Whether the home pose is in a component; then it is in the first one."""
        return any(component.contains_home for component in self.components)

    @property
    def home_component(self) -> Component:
        """The first component with the home pose, or an error if there is none.

        Raises
        ------
        NoHomeError
            If there is none; the message names what the home pose violates, and by how much.

        Examples
        --------
        >>> from dataclasses import replace
        >>> from cspace import find_region, load_robot
        >>> robot = load_robot("minervabot-v2")
        >>> find_region(robot).home_component
        <Component: area 11.78 rad^2, 6 vertices, 1 loop, with home>
        >>> bent = replace(robot.joints[1], limits=(0.5, 2.0))
        >>> limited = replace(robot, joints=(robot.joints[0], bent))
        >>> find_region(limited).home_component  # doctest: +ELLIPSIS
        Traceback (most recent call last):
        cspace.region.region.NoHomeError: the home pose is in no component: q2.lower is violated ...
        """
        if not self.has_home:
            raise NoHomeError(f"the home pose is in no component: {_why_no_home(self)}")
        return self.components[0]

    @property
    def area(self) -> float:
        """Sum of all components' areas."""
        return sum(component.area for component in self.components)

    @property
    def area_unit(self) -> str:
        """Unit of areas: the product of both joints' units."""
        return self.problem.area_unit

    @property
    def robot(self) -> Robot:
        """The robot; ValueError if the region is of forms without a robot."""
        return self._robot_for("robot")

    def _robot_for(self, asked: str) -> Robot:
        """Return the robot, or raise an error that names the caller's purpose."""
        if self.problem.robot is None:
            raise ValueError(
                f"{asked}: this region is of forms, not of a robot; plot, sample, nearest,"
                " to_geojson and to_shapely need none"
            )
        return self.problem.robot

    @property
    def boundaries(self) -> tuple[str, ...]:
        """Names of the columns of `margins`: boundaries, then limits."""
        return self.problem.evaluator.names

    def margins(self, q: ArrayLike) -> Floats:
        """Return margins, shape (..., 2) to (..., m): lengths, of limits joint units (eqs. 9-12).

        Margins are negative where violated; a margin that is negative by rounding alone is 0.

        Raises
        ------
        ValueError
            If a joint value is NaN or infinite, or there are not two on the last axis.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> region = find_region(load_robot("minervabot-v2"))
        >>> region.boundaries
        ('B1', 'B2', 'B3', 'B4', 'B7')
        >>> region.margins([0.2, -0.5]).round(3).tolist()
        [13.296, 23.914, 12.395, 19.261, 41.05]

        A million configurations are one call. NaN is refused:

        >>> region.margins([[0.2, -0.5], [0.8, 0.3]]).shape
        (2, 5)
        >>> region.margins([0.2, float("nan")])
        Traceback (most recent call last):
        ValueError: a joint value is NaN or infinite
        """
        return self.problem.evaluator.margins(q)

    def contains(self, q: ArrayLike) -> Bools:
        """Tell where configurations, shape (..., 2), are feasible: every margin is >= 0.

        Feasible is not safe: links may overlap where the file's boundaries are about points
        (`Robot.feasible_by`, `Robot.unchecked`).

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> region = find_region(load_robot("minervabot-v2"))
        >>> region.contains([[0.2, -0.5], [1.5, 0.0]]).tolist()
        [True, False]

        A configuration on the boundary itself is feasible:

        >>> bool(region.contains(region.home_component.vertices[0].q))
        True
        """
        return self.problem.evaluator.feasible(q)

    def components_of(self, q: ArrayLike) -> tuple[int, ...]:
        """Return every component, by index, whose closure holds a configuration, shape (2,).

        Modulo full turns of a joint without limits; errors as in `margins`.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> region = find_region(load_robot("minervabot-v2"))
        >>> region.components_of([0.2, -0.5]), region.components_of([1.5, 0.0])
        ((0,), ())

        Both configurations may be feasible, and yet the arm cannot go from one to the other:

        >>> region.components_of([0.2, 2.5])
        (1,)
        """
        _ = self.components  # an unresolved region raises
        placed = closures(self.problem, self.cells, self.base, real_numbers(q))
        return tuple(sorted({self.owner[one.cell] for one in placed if one.cell in self.owner}))

    @overload
    def component_of(self, q: Sequence[float]) -> int | None: ...
    @overload
    def component_of(self, q: ArrayLike) -> Any: ...
    def component_of(self, q: ArrayLike) -> Any:
        """Return the number of the component of each configuration, one or many.

        Parameters
        ----------
        q : array_like, shape (2,) or (..., 2)
            Rad or length; modulo full turns of a joint without limits.

        Returns
        -------
        int or None, or ndarray of int, shape (...)
            The first of `components_of`. Where there is none it is None for one configuration, and
            -1 in an array.

        Raises
        ------
        ValueError
            As `margins`.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> region = find_region(load_robot("minervabot-v2"))
        >>> region.component_of([0.2, -0.5])
        0
        >>> print(region.component_of([1.5, 0.0]))
        None

        A million configurations are one call:

        >>> region.component_of([[0.2, -0.5], [1.5, 0.0], [0.2, 2.5]]).tolist()
        [0, -1, 1]
        """
        places = real_numbers(q)
        if places.ndim < 2:
            return next(iter(self.components_of(places)), None)
        _ = self.components
        flat = self.problem.evaluator.shaped(places).reshape(-1, 2)
        found = numbered(self.problem, self.cells, self.base, self.owner, flat)
        return found.reshape(places.shape[:-1])

    def nearest(
        self, q: ArrayLike, component: int | None = None, weights: Sequence[float] = (1.0, 1.0)
    ) -> BoundaryPoint:
        """Return the point of the boundary that is nearest to a configuration, feasible or not.

        Parameters
        ----------
        q : array_like, shape (2,)
            rad or length.
        component : int, optional
            Use only the boundary of this component; default: of all components.
        weights : sequence of two float
            Weight of a unit of each joint. If one joint turns and one slides, give the length of
            the arm as the weight of the turning joint.

        Returns
        -------
        BoundaryPoint
            With ``q``, ``boundary``, ``component``, ``distance`` (`cspace.measures.nearest`).

        Raises
        ------
        ValueError
            If there is no boundary, or a weight or joint value is not allowed.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> point = find_region(load_robot("minervabot-v2")).nearest([0.2, -0.5])
        >>> point.boundary, point.q.round(3).tolist(), round(point.distance, 3)
        ('B7', [0.898, -0.223], 0.751)
        """
        from cspace.measures.nearest import nearest_boundary

        self._check_number(component)
        return nearest_boundary(self, q, component, weights)

    def _check_number(self, component: int | None) -> None:
        """Refuse the number of a component that does not exist, such as -1 for no component."""
        count = len(self.components)
        if component is not None and component not in range(count):
            raise ValueError(f"component {component}: there are {count}, numbered from 0")

    def sample(self, n: int, seed: np.random.Generator | int | None = None) -> Floats:
        """Draw feasible configurations, evenly over the area of all components.

        Parameters
        ----------
        n : int
        seed : int or numpy.random.Generator, optional
            The seed of a generator, or the generator; the same seed draws the same configurations.

        Returns
        -------
        ndarray, shape (n, 2)
            Rad or length; a joint that turns all the way round in (-pi, pi].

        Raises
        ------
        ValueError
            If the region is empty.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> region = find_region(load_robot("minervabot-v2"))
        >>> q = region.sample(1000, seed=1)
        >>> q.shape, bool(region.contains(q).all())
        ((1000, 2), True)
        """
        if not self.components:
            raise ValueError("the region is empty: there is nothing to draw from")
        own, n = np.array(sorted(self.owner)), whole_number("n", n, 0)
        return drawn(self.problem, self.cells, self.base, own, n, np.random.default_rng(seed))

    def plot(
        self,
        ax: Axes | None = None,
        *,
        component: int | None = None,
        unit: Literal["deg", "rad"] = "deg",
        **style: Any,
    ) -> Axes:
        """Draw the components and return the axes.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Default: those of a new figure.
        component : int, optional
            Draw this component alone.
        unit : {"deg", "rad"}
            Of the angles on both axes; lengths are in the robot's unit. Joint values of your own
            fit onto axes in radians.
        **style
            What matplotlib's patches take: ``facecolor``, ``alpha``, ``label``, ...

        Examples
        --------
        >>> from matplotlib.figure import Figure
        >>> from cspace import find_region, load_robot
        >>> figure = Figure()
        >>> axes = find_region(load_robot("pp-portal")).plot(figure.subplots())
        >>> axes.get_xlabel()
        'beam / mm'

        Points of your own are laid over a picture in radians:

        >>> region = find_region(load_robot("minervabot-v2"))
        >>> axes = region.plot(figure.subplots(), unit="rad", facecolor="tab:green", alpha=0.5)
        >>> points = axes.plot(*region.sample(100, seed=1).T, ".")

        Without axes, `plot` opens a new figure with `matplotlib.pyplot`.
        """
        from cspace.figures.pictures import plot_region

        self._check_number(component)
        return plot_region(self, ax, component=component, unit=unit, **style)

    def explore(self) -> Any:
        """Return the page in which one moves the arm; Jupyter shows it inline.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> page = find_region(load_robot("pp-portal")).explore()
        >>> page.save("portal.html")  # doctest: +SKIP
        """
        from cspace.explorer import explore

        self._robot_for("explore")
        return explore(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the region as plain data, schema qbound/region/4, as `--json` writes it.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> document = find_region(load_robot("minervabot-v2")).to_dict()
        >>> document["schema"], document["joints"], len(document["components"])
        ('qbound/region/4', ['q1', 'q2'], 5)
        >>> document["home"]
        {'q': [0.0, 0.0], 'feasible': True, 'violated': []}
        """
        from cspace.export.document import region_document

        self._robot_for("to_dict")
        return region_document(self)

    def to_geojson(self, deviation: float = 1e-3) -> dict[str, Any]:
        """Return polygons as GeoJSON, no farther from the arcs than `deviation`.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> drawn = find_region(load_robot("minervabot-v2")).to_geojson(deviation=0.01)
        >>> drawn["type"], len(drawn["features"])
        ('FeatureCollection', 5)
        >>> drawn["features"][0]["properties"]["deviation"] <= 0.01
        True
        """
        from cspace.export.outlines import find_outlines, outlines_geojson

        return outlines_geojson(find_outlines(self, deviation))

    def to_shapely(self, deviation: float = 1e-3, component: int | None = None) -> MultiPolygon:
        """Return polygons, no farther from the arcs than `deviation`, as one shapely geometry.

        The polygons are of one component, if it is given.

        Warns
        -----
        UserWarning
            If shapely finds that the polygons are not valid, because pieces touch or a slit is
            thinner than the deviation. The message names the first place; ``is_valid`` is False.

        Examples
        --------
        >>> from cspace import find_region, load_robot
        >>> region = find_region(load_robot("minervabot-v2"))
        >>> drawn = region.to_shapely()
        >>> len(drawn.geoms), round(region.area, 3), round(drawn.area, 3)
        (5, 25.843, 25.846)

        The polygons bound the region only up to the deviation; the arcs are exact.
        """
        from cspace.export.outlines import find_outlines, outlines_shapely

        self._check_number(component)
        return outlines_shapely(find_outlines(self, deviation), component)

    def _repr_svg_(self) -> str:
        """Return the picture that Jupyter shows."""
        from cspace.figures.pictures import region_picture

        return region_picture(self).decode()


def find_region(robot: Robot, held: Held | None = None) -> Region:
    """Find every component of the feasible region of two joints (eqs. 9-12).

    Feasible is where every boundary keeps its clearance, which is 0 where the file states none.

    Parameters
    ----------
    robot : Robot
    held : mapping of int or str to float, optional
        Values of all joints but two, by index or name; rad or length.

    Raises
    ------
    ValueError
        If not exactly two joints are left free, or `held` names no joint or no finite number.
    TypeError
        If `robot` is not a `Robot`, such as the name of one.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> region
    <Region of MinervaBotV2: 5 components, with home, area 25.8433 rad^2>
    >>> region.home_component
    <Component: area 11.78 rad^2, 6 vertices, 1 loop, with home>

    A region may be empty. This is not an error, and the region names the boundaries that cause it;
    here the floor is raised above the arm's reach:

    >>> from dataclasses import replace
    >>> robot = load_robot("minervabot-v2")
    >>> floor = replace(robot.boundary("B7"), offset=100.0)
    >>> region = find_region(replace(robot, boundaries=(floor,)))
    >>> region.components, region.has_home, region.empty_because
    ((), False, ('B7',))

    A region has two joints, and all others are held, by name or by index:

    >>> find_region(robot, held={"q2": 0.3})  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: a region has two joints; MinervaBotV2 has 1 that are not held ...
    """
    refuse_no_robot("find_region", robot)
    return solve(clearance_problem(robot, held))


def solve(problem: Problem, home: ArrayLike | None = None, base: int | None = None) -> Region:
    """Find every component of { all forms > 0, strictly within the ranges }.

    Parameters
    ----------
    home : array_like, shape (2,), optional
        Configuration whose component comes first and is unrolled around it; default: the problem's
        home.
    base : int, optional
        Which joint is the base of the cells; the components do not depend on it.

    Notes
    -----
    A component is open, and pictures show its closure. Contact in points or curves neither joins
    components nor makes one.

    A region is returned only if its own check finds no fault (`faults`). If balls decided anything,
    or critical values nearly coincide, the region over the other joint must agree with it.
    """
    if not isinstance(problem, Problem):
        refuse_type("problem", problem, "a Problem (find_region takes a robot)")
    if base not in (None, 0, 1):
        raise ValueError(f"base: 0 or 1 is wanted, found {base!r}")
    home = problem.free_home if home is None else home
    home = np.zeros(2) if home is None else real_numbers(home)
    if base is None:  # the lift of the two kinds slides
        base = 1 if problem.forms.kinds == ("prismatic", "revolute") else 0
    found = _verified(problem, home, base)
    if not found.unresolved and (not _is_delicate(found) or _agrees(found, home)):
        return found
    reasons: Sequence[str] = ()
    for cautions in (CAUTION, CAUTION[1:]):
        one, other = (_verified(problem, home, joint, cautions) for joint in (base, 1 - base))
        if bool(one.unresolved) != bool(other.unresolved):
            return other if one.unresolved else one
        reasons = one.unresolved + other.unresolved or _differences(one, other)
        if not reasons:
            return one
    return _unresolved(problem, base, reasons)


def _verified(
    problem: Problem, home: Floats, base: int, cautions: Sequence[float] = CAUTION
) -> Region:
    """Return the region over a joint if its check finds no fault, else one that says why not.

    A region with faults is computed again with more decisions left to balls.
    """
    for caution in cautions:
        try:
            region = _over(problem, home, base, caution)
            reasons = faults(region)
        except UndecidedError as error:
            reasons = [str(error)]
        if not reasons:
            return region
    return _unresolved(problem, base, reasons)


def _over(problem: Problem, home: Floats, base: int, caution: float) -> Region:
    """Find a region over one joint: a cylindrical decomposition with Theorem 2 as its lifting step.

    1. Constraints: a form for each boundary (eqs. 9-12), without those that no joint moves.
    2. Relevant ones: of many forms those that are proved to bind nowhere are left out.
    3. Events: base values at which roots along the lift (Theorem 2) meet, appear, or pass an end.
    4. Cells: between two events nothing changes; all forms are positive between two roots.
    5. Adjacency: cells touch over an open interval of a line on which all forms are positive.
    6. Components: sets of cells that are joined. 7. Outlines: the closed loops of arcs round each
    component. 8. `_verified` asks the margins whether the result is right.

    Only the forms are the paper's; steps 3 to 8 are not in it.
    """
    constraints, irrelevant = problem.searched
    precise = Precise.of(constraints, base, caution)
    if problem.blocked:  # a form that no joint moves leaves no room
        decomposition = nothing_in(precise)
    else:
        events, contacts = find_events(precise)
        decomposition = find_cells(events, contacts)
    cells = CellComplex(decomposition)
    components = outlined(problem, constraints, cells, home)
    owner = {k: i for i, (_, own) in enumerate(components) for k in own}
    found = tuple(component for component, _ in components)
    return Region(found, problem, constraints, cells, base, owner, irrelevant)


def _unresolved(problem: Problem, base: int, reasons: Sequence[str]) -> Region:
    """Return a region without components that says why it is unresolved."""
    inner, irrelevant = problem.searched
    cells, why = CellComplex(nothing_in(Precise.of(inner, base))), tuple(dict.fromkeys(reasons))
    return Region((), problem, inner, cells, base, {}, irrelevant, why)


def _is_delicate(region: Region) -> bool:
    """Tell whether balls decided anything, or critical values nearly coincide."""
    lines = region.cells.abscissae
    near = DELICATE * (lines[-1] - lines[0])
    decided = region.cells.decomposition.precise.decided
    return bool(decided or (np.diff(lines) < near).any())


DELICATE = 1e-6
"""Two critical values nearer than this part of the range: the other joint is asked, too."""


def _agrees(region: Region, home: Floats) -> bool:
    """Tell whether the region over the other joint is the same, without a look at its faults."""
    try:
        other = _over(region.problem, home, 1 - region.base, CAUTION[0])
    except UndecidedError:
        return False
    return not _differences(region, other)


def _differences(one: Region, other: Region) -> list[str]:
    """Return the differences of two regions of one problem, one found over each joint."""
    counts = _counts(one), _counts(other)
    found = [
        f"{n} {what} over one joint, {m} over the other"
        for what, n, m in zip(("components", "loops", "vertices"), *counts, strict=True)
        if n != m
    ]
    if not found and one.components:
        areas = np.array([sorted(c.area for c in region.components) for region in (one, other)])
        plane, off = one.cells.plane, float(np.ptp(areas, axis=0).max())
        rounding = 64 * UNIT * plane.base_unit * plane.lift_unit
        if off > SAME_AREA * max(one.area, other.area) + rounding:
            found.append(f"an area differs by {off:.2g} between the joints")
    return found


def _counts(region: Region) -> tuple[int, int, int]:
    """Count the components of a region, their loops and their vertices."""
    loops = sum(len(component.loops) for component in region.outlined)
    return (
        len(region.outlined),
        loops,
        sum(len(component.vertices) for component in region.outlined),
    )


SAME_AREA = 1e-9
"""Part of the whole area by which areas over either joint may differ."""


def _why_no_home(region: Region) -> str:
    """Return a text: what a home pose in no component violates, or else touches."""
    problem = region.problem
    if problem.free_home is None or problem.robot is None:
        return "it lies in none of them"
    found = dict(zip(region.boundaries, region.margins(problem.free_home).tolist(), strict=True))
    written = partial(margin_text, problem.robot, limited=region.limited, degree="°", digits=4)
    lost = [f"{name} is violated by {written(name, -m)}" for name, m in found.items() if m < 0]
    touched = [name for name, margin in found.items() if margin == 0]
    return printable("; ".join(lost) or f"it touches {', '.join(touched)} and has no room there")


PLACES = (-1.2, -0.4, 0.3, 1.0)
"""Where the middle piece of each arc is looked at: angles, from -pi/2 (start) to pi/2 (end)."""

BESIDE = (1e-6, 1e-9, 1e-12)
"""How far beside an arc it is asked what lies there, in units of a joint; then balls are asked."""

NEAR_CORNERS = (0.11, 0.83), (0.79, 0.19)
"""Where else a cell is looked at: parts of its width, and of its height there."""

SPREAD_OUT = np.modf(np.outer(np.arange(1, 65), [0.7548776662466927, 0.5698402909980532]))[0]
"""Places in the unit square that are spread evenly (Roberts's sequence), shape (64, 2)."""

CLEAR = 64.0
"""A margin beyond so many times its rounding has a sign."""


def faults(region: Region) -> list[str]:
    """Return sentences about what is wrong with a region; empty if nothing is.

    The margins are evaluated at some places to check four facts. Each arc and vertex lies on its
    boundaries. Each cell is free in its middle and near two corners, and its boundaries are
    violated just beyond. The number of loops agrees with Euler's count of the cells. Free places
    all over the ranges lie in a cell.
    """
    return [*_off(region), *_Cells(region).faults(), *_loops(region), *_lost(region)]


def _lost(region: Region) -> list[str]:
    """Check places all over the ranges: each place that is free beyond rounding lies in a cell."""
    if region.problem.blocked:  # a boundary that touches everywhere leaves no component
        return []
    ends = [(-np.pi, np.pi) if r is None else r for r in region.problem.ranges]
    low, high = np.array(ends).T
    q = low + (high - low) * SPREAD_OUT
    evaluator = region.problem.evaluator
    free = evaluator.at_least(q, CLEAR * evaluator.margin_rounding).all(axis=1)
    part = numbered(region.problem, region.cells, region.base, region.owner, q[free])
    missed = q[free][part < 0]
    return [f"({x:.9g}, {y:.9g}) is free and in no cell" for x, y in missed.tolist()]


def _off(region: Region) -> Iterator[str]:
    """Yield the arcs and vertices that do not lie on their boundaries."""
    arcs = [arc for part in region.outlined for loop in part.loops for arc in loop]
    if not arcs:
        return
    column = {name: k for k, name in enumerate(region.problem.evaluator.names)}
    laid = arcs[0].laid  # all arcs are laid behind one another
    first, end = np.array([arc.span for arc in arcs]).T
    inner = laid[(first + end - 1) // 2].places(np.array(PLACES)).reshape(-1, 2)
    of, piece = ranges(first, end)
    q = np.concatenate([inner, ordered(laid.start[piece], laid.base)])
    of = np.concatenate([np.arange(len(arcs)).repeat(len(PLACES)), of])
    starts = {tuple(arc.start.tolist()) for arc in arcs}
    for vertex in (vertex for part in region.outlined for vertex in part.vertices):
        if tuple(vertex.q.tolist()) not in starts:
            yield f"a vertex of {' and '.join(vertex.boundaries)} is not where an arc starts"
    limited = np.array([arc.row < 0 for arc in arcs])[of]
    rows = np.array([0 if arc.row < 0 else column[arc.boundary] for arc in arcs])[of]
    evaluator = region.problem.evaluator
    within = ON_ARC * evaluator.sizes
    held, more = (evaluator.at_least(q, least) for least in (-within, np.nextafter(within, np.inf)))
    off = np.take_along_axis(~held | more, rows[:, None], axis=1)[:, 0]
    if limited.any():
        off[limited] = _to_limits(region, q[limited]) > ON_ARC
    for k in which(off).tolist():
        at = ", ".join(f"{x:.9g}" for x in q[k])
        if limited[k]:
            by = float(_to_limits(region, q[k]))
        else:
            by = abs(float(evaluator.margins(q[k])[rows[k]]))
        yield f"an arc of {arcs[of[k]].boundary} is {by:.2g} off it at ({at})"
    for k, column_number in np.argwhere(~held).tolist():
        at = ", ".join(f"{x:.9g}" for x in q[k])
        name = evaluator.names[column_number]
        yield f"an arc of {arcs[of[k]].boundary} runs where {name} is violated, at ({at})"


def _to_limits(region: Region, q: Floats) -> Floats:
    """Return how far configurations, (..., 2), are from the nearest limit, in units of a joint."""
    plane, gaps = region.cells.plane, []
    units = plane.base_unit, plane.lift_unit
    for j, limits in enumerate(region.problem.ranges):
        unit = units[0] if j == region.base else units[1]
        gaps += [(q[..., j] - end) / unit for end in limits or ()]
    return np.asarray(np.abs(gaps).min(axis=0))


class _Cells:
    """Checks of the cells of a region: free in the middle, and not beyond their ends."""

    def __init__(self, region: Region) -> None:
        self.cells, self.plane, inner = region.cells, region.cells.plane, region.inner
        self.decomposition = region.cells.decomposition
        evaluator = region.problem.evaluator
        self.evaluator, self.doubt = evaluator, CLEAR * evaluator.margin_rounding
        self.column = {name: k for k, name in enumerate(evaluator.names)}
        self.names = [*inner.names, *(inner.contacts.boundaries[k] for k in inner.contacts.pair)]

    def faults(self) -> list[str]:
        """Return sentences about what is wrong."""
        cells = self.cells
        every = np.arange(len(cells.slabs))
        if not len(every):
            return []
        start, end = cells.spans(every).T
        t = start + INSIDE * (end - start)
        low, high = cells.interval(every, t[:, None])[..., 0]
        middle = low + INSIDE * (high - low)
        found, q = self._crossed(start, end), self._ordered(t, middle)
        vague = which(~self.evaluator.at_least(q, self.doubt).all(axis=1))
        kept = self.evaluator.at_least(q[vague], -self.doubt)
        for k, held in zip(vague.tolist(), kept, strict=True):
            if not (held.all() and self._is_free(k, t[k], start[k], end[k])):
                found.append(f"a cell about {self._place(t[k], middle[k])} is not free")
        for side, value, sense in ((0, low, -1.0), (1, high, 1.0)):
            rows = which(cells.roots[:, side, 0] >= 0)
            names = [
                self.decomposition.names[s] for s in self.decomposition.sets[rows, side].tolist()
            ]
            shut = self._shut(names, t[rows], value[rows], np.zeros(len(rows)), sense)
            for k in rows[~shut].tolist():
                if not self._is_shut(k, side, t[k], start[k], end[k]):
                    place = self._place(t[k], value[k])
                    found.append(f"beyond a cell's end at {place} nothing is violated")
        return found + self._standing()

    def _crossed(self, start: Floats, end: Floats) -> list[str]:
        """Check near the corners of cells that are not thin that nothing is violated."""
        wide = which(end - start > DELICATE * self.plane.base_unit)
        part, up = np.array(NEAR_CORNERS).T
        t = start[wide, None] + part * (end - start)[wide, None]
        low, high = self.cells.interval(wide, t)
        v = low + up * (high - low)
        q = self._ordered(t.ravel(), v.ravel())
        bad = which(~self.evaluator.at_least(q, -self.doubt).all(axis=1))
        places = (self._place(t.flat[k], v.flat[k]) for k in bad.tolist())
        return [f"a cell about {place} is not free" for place in places]

    def _standing(self) -> list[str]:
        """Check both sides of pieces of boundary along a fibre."""
        cells, elements = self.cells, self.cells.elements
        found = []
        for side, sense in ((0, 1.0), (1, -1.0)):
            rows = which(~elements.joined & (elements.cell[side] >= 0))
            line = elements.line[rows]
            t = cells.abscissae[line]
            ends = np.asarray(self.plane.ends)
            if self.plane.base_range is not None:
                kept = ~np.isin(t, ends)
                rows, line, t = rows[kept], line[kept], t[kept]
            v = (elements.low[rows] + elements.high[rows]) / 2
            standing = [self.decomposition.standing.get(k, ()) for k in line.tolist()]
            other = elements.cell[1 - side][rows] >= 0  # it only touches: free on both sides
            shut = self._shut(standing, t, v, np.full(len(rows), sense), 0.0) | other
            for k in which(~shut).tolist():
                if not standing[k]:
                    found.append(f"nothing bounds a cell at {self._place(t[k], v[k])}")
        return found

    def _ordered(self, t: Floats, v: Floats) -> Floats:
        return ordered(np.stack([t, v], axis=1), self.plane.base)

    def _place(self, t: float, v: float) -> str:
        one, other = (t, v) if self.plane.base == 0 else (v, t)
        return f"({one:.9g}, {other:.9g})"

    def _shut(
        self, rows: list[tuple[int, ...]], t: Floats, v: Floats, along: Floats, up: float
    ) -> Bools:
        """Tell where some row's boundary is violated slightly beside places, beyond rounding."""
        shut = np.zeros(len(rows), dtype=np.bool_)
        for step in BESIDE:
            left = which(~shut)
            if not len(left):
                break
            base = t[left] + step * self.plane.base_unit * along[left]
            q = self._ordered(base, v[left] + step * self.plane.lift_unit * up)
            violated = ~self.evaluator.at_least(q, -self.doubt)
            for k, own in zip(left.tolist(), violated, strict=True):
                shut[k] = any(own[self.column[self.names[row]]] for row in rows[k])
        return shut

    # --- in balls -------------------------------------------------------------------------------

    def _exactly(self, k: int, t: float, start: float, end: float) -> Any:
        """Return an exact base value inside a cell's slab."""
        lines, slab = self.decomposition.critical, int(self.cells.slabs[k])
        if end - start > 1e3 * UNIT * max(abs(start), abs(end)):
            return flint.arb(t)
        with precision(LEVELS[-1]):
            ends = [lines.ball(line, LEVELS[-1]) for line in (slab, slab + 1)]
            return flint.arb((sum(ends) / 2).mid())

    def _is_free(self, k: int, t: float, start: float, end: float) -> bool:
        """Tell in balls whether a cell's middle is free."""
        precise, base = self.decomposition.precise, self._exactly(k, t, start, end)

        def middle(bits: int) -> Any:
            low, high = (self._root(k, side, base, bits) for side in (0, 1))
            with precision(bits):
                return low + (high - low) * 3 / 7

        return _free(precise, base, middle)

    def _root(self, k: int, side: int, base: Any, bits: int) -> Any:
        form, branch, _ = self.cells.roots[k, side].tolist()
        near = self.cells.interval([k], np.array([[float(base.mid())]]))[side, 0, 0]
        return turned_root(self.decomposition.precise, form, branch, base, bits, float(near))

    def _is_shut(self, k: int, side: int, t: float, start: float, end: float) -> bool:
        """Tell in balls whether a cell's boundary is violated just beyond one of its ends."""
        precise, base = self.decomposition.precise, self._exactly(k, t, start, end)

        def beyond(bits: int) -> Any:
            with precision(bits):
                step = flint.arb(2) ** -min(bits // 4, 100) * self.plane.lift_unit
                return self._root(k, side, base, bits) + (step if side else -step)

        count, contacts = self.plane.count, self.plane.contacts
        for row in self.decomposition.names[int(self.decomposition.sets[k, side])]:
            if row < count:
                if precise.sign(row, base, beyond) < 0:
                    return True
            elif not apart(precise, int(contacts.pair[row - count]), base, beyond):
                return True
        return self._goes_on(k, side, base)

    def _goes_on(self, k: int, side: int, base: Any) -> bool:
        """Tell whether another cell begins where a cell ends, so that it only touches a curve."""
        cells, t = self.cells, np.array([[float(base.mid())]])
        own = which(cells.slabs == cells.slabs[k])
        ends = cells.interval(own, np.broadcast_to(t, (len(own), 1)))[..., 0]
        here = ends[side, own == k][0]
        gap = ends[1 - side] - here
        if cells.circle:
            gap -= TURN * np.round(gap / TURN)
        return bool((np.abs(gap) <= BESIDE[0] * self.plane.lift_unit).any())


def _free(precise: Precise, base: Any, place: Any) -> bool:
    """Tell in balls whether every form is positive at a place and all bodies are apart."""
    plane = precise.plane
    return all(precise.sign(row, base, place) > 0 for row in range(plane.count)) and all(
        apart(precise, pair, base, place) for pair in range(plane.pairs)
    )


def _loops(region: Region) -> list[str]:
    """Compare the number of loops of each component with Euler's count of its cells.

    A component consists of cells joined over open elements of lines. A cell counts 1 and an element
    -1, or 0 for whole circles; a point between two elements that join the same cells counts 1. In a
    plane or on a cylinder the number of loops is 2 minus this sum. If the component is a torus less
    some holes, the number is smaller by 2.
    """
    cells, owner = region.cells, region.owner
    part = np.array([owner.get(k, -1) for k in range(len(cells.slabs))], dtype=np.int64)
    part[part >= len(region.outlined)] = -1
    wrong = [] if (part >= 0).all() else ["a cell is in no component"]
    if len(region.outlined) != len(cells.parts.cells):
        wrong.append(f"{len(region.outlined)} components, but {len(cells.parts.cells)} of cells")
    count = np.bincount(
        part[part >= 0], (~cells.whole[part >= 0]).astype(float), len(region.outlined)
    )
    elements = cells.elements
    joined = which(elements.joined & ~cells.is_circle)
    for rows, change in ((joined, -1), (_between(cells), 1)):
        parts = part[elements.cell[0, rows]]
        np.add.at(count, parts[parts >= 0], change)
    for k, component in enumerate(region.outlined[: len(count)]):
        wanted = {2 - int(count[k])} | ({-int(count[k])} if all(component.wraps) else set())
        if len(component.loops) not in wanted:
            wrong.append(f"component {k} has {len(component.loops)} loops, not {min(wanted)}")
    return wrong


def _between(cells: CellComplex) -> Ints:
    """Return the elements that only a point separates from the next one of the same cells."""
    elements = cells.elements
    n = len(elements.line)
    if not n:
        return np.zeros(0, dtype=np.int64)
    following = np.arange(1, n + 1)
    new = np.append(elements.line[1:] != elements.line[:-1], True)
    first = np.append(True, new[:-1])
    last = which(new)
    following[last] = which(first) if cells.circle else last
    same = (elements.cell == elements.cell[:, following]).all(axis=0)
    alone = following == np.arange(n)
    # A circle that is one element has no end, so nothing lies between.
    return which(same & elements.joined & elements.joined[following] & ~alone)
