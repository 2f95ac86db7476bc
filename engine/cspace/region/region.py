"""The feasible region of two joints, complete: components, labelled arcs, vertices, measures.

`find_region` states the problem. `_over` sees it over a base, and finds the events, the free cells
between them, what joins the cells, the components, and their outlines (sentences 1 to 12). `solve`
checks the result against the margins, which know nothing of cells (sentence 13).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import chain
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arguments import refuse_type, whole_number
from cspace.arrays import Bools, Floats
from cspace.model.robot import Held, Joint, Robot, real_numbers, refuse_no_robot
from cspace.printable import printable
from cspace.region.algebra import HIGH, LOW, basis, fold, lift_roots
from cspace.region.arcs import Component, Pieces, integrate, ordered
from cspace.region.cells import find_cells, no_cells
from cspace.region.components import find_joins, find_parts
from cspace.region.exact import TiltedError, UndecidedError
from cspace.region.kinds import first_of, matches
from cspace.region.outline import cell_map, outlined
from cspace.region.places import CellMap
from cspace.region.problem import Problem, clearance_problem
from cspace.region.scene import scene_of
from cspace.tolerances import ON_ARC
from cspace.units import limited_joints, margin_text
from qbound.circle import TURN

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from shapely import MultiPolygon

    from cspace.measures.nearest import BoundaryPoint

TRIED = 1000
"""Random places with which `irreducible` begins."""

INSIDE = 3 / 7
"""Part of a cell's width and height: off the middle, because symmetric bodies may touch there."""


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
    low, high = np.array([(-np.pi, np.pi) if r is None else r for r in problem.ranges]).T
    rows = _violated(problem, np.random.default_rng(0).uniform(low, high, (TRIED, 2)))
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
    found = cell_map(find_cells(scene_of(problem, base)))
    if not len(found.span):
        return None
    k = int(np.diff(found.spans(range(len(found.span))))[:, 0].argmax())  # the widest cell
    start, end = found.spans([k])[0]
    t = start + INSIDE * (end - start)
    low, high = found.interval([k], np.array([[t]]))[:, 0, 0]
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
    cells : CellMap
        The cells of the components.
    base : int
        Which joint is the base of the cells.
    irrelevant : tuple of str
        Boundaries that were proved to bound nothing here (`relevant_forms`) and took no part in the
        search; `margins` and `contains` still use them.
    unresolved : tuple of str
        Which check of its own the region did not pass, and where; mostly empty. Otherwise
        `components`, and everything that needs them, raise `UnresolvedError`; `contains` and
        `margins` still work.

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
    cells: CellMap
    base: int
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
        cspace.region.region.NoHomeError: the home pose is in no component: q2.lower ...
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
        placed = self.cells.closures(self.problem, real_numbers(q))
        return tuple(sorted({int(self.cells.owner[one.cell]) for one in placed}))

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
        found = self.cells.numbered(self.problem, flat)
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
        n = whole_number("n", n, 0)
        return self.cells.drawn(self.problem, n, np.random.default_rng(seed))

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

        The polygons are of one component, if it is given. A slit without area, where two holes
        touch, is left out: then one component may be several polygons.

        Warns
        -----
        UserWarning
            If shapely finds that the polygons are not valid, because pieces touch or cross by less
            than the deviation. The message names the first place; ``is_valid`` is False.

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
    """Find every component of { all forms > 0, bodies apart, strictly within the ranges }.

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

    A region is returned only if its own check finds no fault (`faults`). Where there is one, the
    region is found again with errors enlarged, so that more is asked of exact numbers, and then
    over the other joint. What fails then is unresolved. A region that may be wrong (`looked_over`)
    is returned if the one over the other joint has the same structure (sentence 13).
    """
    if not isinstance(problem, Problem):
        refuse_type("problem", problem, "a Problem (find_region takes a robot)")
    if base not in (None, 0, 1):
        raise ValueError(f"base: 0 or 1 is wanted, found {base!r}")
    home = problem.free_home if home is None else home
    home = np.zeros(2) if home is None else real_numbers(home)
    if base is None:  # the lift of the two kinds slides
        base = 1 if problem.forms.kinds == ("prismatic", "revolute") else 0
    reasons: list[str] = []
    doubted: list[Region] = []
    for over, caution in ((base, 1.0), (base, CAUTION), (1 - base, 1.0)):
        try:
            region = _over(problem, home, over, caution)
            found, vague = looked_over(region)
        except UndecidedError as error:
            found, vague = [f"{error} is not decided"], []
        if not found:
            if not vague:
                return region
            doubted.append(region)
        reasons += found + vague
    for region in doubted:
        if any(region.base != other.base and region == other for other in doubted):
            return region
    return _unresolved(problem, base, reasons)


CAUTION = 2.0**12
"""By how much errors are enlarged where a region was not right."""


def _over(problem: Problem, home: Floats, base: int, caution: float = 1.0) -> Region:
    """Find a region over one joint (sentences 1 to 12).

    This is a cylindrical decomposition with Theorem 2 as its lifting step. Only the forms are the
    paper's; the steps are not in it.
    """
    constraints, irrelevant = problem.searched
    scene = scene_of(constraints, base, caution)
    while True:
        try:
            cells = no_cells(scene) if problem.blocked else find_cells(scene)
            joins = find_joins(cells)
            parts = find_parts(cells, joins)
            outlines, own = outlined(cells, joins, parts, constraints, problem, home)
        except TiltedError as error:  # a form is rounded, and that matters
            scene = error.scene
        else:
            return Region(outlines, problem, constraints, own, base, irrelevant)


def _unresolved(problem: Problem, base: int, reasons: Sequence[str]) -> Region:
    """Return a region without components that says why it is unresolved."""
    inner, irrelevant = problem.searched
    none = cell_map(no_cells(scene_of(inner, base)))
    return Region((), problem, inner, none, base, irrelevant, tuple(dict.fromkeys(reasons)))


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


def _counts(region: Region) -> tuple[int, int, int]:
    """Count the components of a region, their loops and their vertices."""
    parts = region.outlined
    loops, vertices = (sum(len(getattr(p, what)) for p in parts) for what in ("loops", "vertices"))
    return len(parts), loops, vertices


# --- the check (sentence 13) ----------------------------------------------------------------------

ALONG = np.array([-1.5, -1.2, -0.8, -0.4, 0.05, 0.3, 0.7, 1.0, 1.45])
"""Where each arc is looked at: angles, from -pi/2 (start) to pi/2 (end)."""

WITHIN = np.array([[0.43, 0.43], [0.11, 0.83], [0.79, 0.19], [0.013, 0.5], [0.987, 0.5]])
"""Where each cell is looked at: parts of its width, and of its height there."""

BEYOND = 1e-6
"""How far beyond the ends of a cell it is asked what is free, in units of a joint."""

WIDE = 1e-5
"""Cells smaller than this, in units of a joint, are looked at in the middle only."""

ACROSS = np.array([0.43, 0.79, 0.19])
"""Where an edge between two cells is looked at: parts of its length."""

ROOMY = 1e-6
"""A margin, beside its size, that is not 0 although the place of a line is rounded."""

ASIDE = 1e-4
"""How far beside such an edge it is looked at too, in units of a joint."""

GRAZING = 1e-12
"""Part of its size by which a form may miss a double root, and is taken to have one."""

SPREAD = np.modf(np.outer(np.arange(1, 65), [0.7548776662466927, 0.5698402909980532]))[0]
"""Places in the unit square that are spread evenly (Roberts's sequence), shape (64, 2)."""

FEW = 5
"""Of these places, how many show that a form has a double root everywhere."""

CLEAR = 64.0
"""A margin beyond so many times its rounding has a sign."""

SAME_AREA = 1e-9
"""Part of the ranges' area by which areas by cells and by loops may differ."""


def faults(region: Region) -> list[str]:
    """Return what is wrong with a region, in words; empty if nothing is (sentence 13).

    Arcs and vertices lie on their boundaries and nothing is violated there. Cells are free inside.
    Free places, all over the ranges and just beyond the ends of cells, lie in a cell. Cells beside
    each other are joined where they are free, and components are what is joined. Vertices are where
    arcs start. The area within the loops of a component is the area of its cells.
    """
    return looked_over(region)[0]


def looked_over(region: Region) -> tuple[list[str], list[str]]:
    """Return what is wrong with a region (`faults`), and what may be wrong (sentence 13).

    Where bodies touch, or nearly touch, without being violated on either side, a wall without width
    may part what the region has as one. Margins do not tell such a wall from a slit.
    """
    if region.problem.blocked:  # a boundary that touches everywhere leaves no component
        return [], []
    parted, joined = _edges(region)
    wrong = [*_off(region), *_cells(region), *parted, *_parts(region), *_areas(region)]
    return wrong, [*joined, *_grazes(region)]


def _off(region: Region) -> Iterator[str]:
    """Yield the arcs that do not lie on their boundaries, or run where something is violated."""
    arcs = [arc for part in region.outlined for arc in chain(*part.loops)]
    if not arcs:
        return
    evaluator, problem = region.problem.evaluator, region.problem
    column = {name: k for k, name in enumerate(evaluator.names)}
    pieces = Pieces.joined([arc.pieces for arc in arcs])
    count = np.array([len(arc.pieces) for arc in arcs])
    middle = np.cumsum(count) - count + count // 2
    along = pieces[middle].places(ALONG).reshape(-1, 2)
    every = np.arange(len(arcs))
    of = np.concatenate([every.repeat(len(ALONG)), every.repeat(count)])
    q = np.concatenate([along, ordered(pieces.start, region.base)])
    limited = np.array([arc.row < 0 for arc in arcs])[of]
    rows = np.array([0 if arc.row < 0 else column[arc.boundary] for arc in arcs])[of]
    within = ON_ARC * evaluator.sizes
    held, more = (evaluator.at_least(q, least) for least in (-within, np.nextafter(within, np.inf)))
    off = np.take_along_axis(~held | more, rows[:, None], axis=1)[:, 0]
    ends = [(j, end) for j, limits in enumerate(problem.ranges) for end in limits or ()]
    scale = ordered(np.array(region.cells.curves.scale), region.base)
    if limited.any():
        gaps = [np.abs(q[limited, j] - end) / scale[j] for j, end in ends]
        off[limited] = np.min(gaps, axis=0) > ON_ARC
    for k in np.flatnonzero(off).tolist():
        yield f"an arc of {arcs[of[k]].boundary} is off it at {_shown(q[k])}"
    for place in (pieces.start, pieces.end):  # another feature's arc may lie on the boundary too
        for k in np.flatnonzero(pieces.curves.misses(pieces.row, place, ON_ARC)).tolist():
            at = _shown(ordered(place[k], region.base))
            yield f"an arc of {arcs[every.repeat(count)[k]].boundary} leaves its curve at {at}"
    for k, lost in np.argwhere(~held).tolist():
        name = evaluator.names[lost]
        yield f"an arc of {arcs[of[k]].boundary} runs where {name} is violated, at {_shown(q[k])}"


def _cells(region: Region) -> Iterator[str]:
    """Yield places in cells that are not free, and free places in no cell."""
    cells, evaluator, base = region.cells, region.problem.evaluator, region.base
    doubt = CLEAR * evaluator.margin_rounding
    low, high = cells.range.T
    beside = low + (high - low) * SPREAD
    unit, lift_unit = cells.curves.scale
    inner = np.zeros((0, 2))
    if len(cells.span):
        every = np.arange(len(cells.span))
        start, end = cells.spans(every).T
        t = start[:, None] + (end - start)[:, None] * WITHIN[:, 0]
        bottom, top = cells.interval(every, t)
        v = bottom + (top - bottom) * WITHIN[:, 1]
        roomy = ((end - start) > WIDE * unit)[:, None] & (top - bottom > WIDE * lift_unit)
        inner = np.stack([t[roomy], v[roomy]], axis=1)
        for e, (end, way) in enumerate(((bottom, -1), (top, 1))):
            over = np.stack([t[:, 0], end[:, 0] + way * BEYOND * lift_unit], axis=1)
            beside = np.concatenate([beside, over[cells.row[:, e] >= 0]])
        outside = ((beside < low) | (beside > high)) & ~np.array(cells.round)
        beside = beside[~outside.any(axis=1)]
    q = ordered(inner, base)
    for place in q[~evaluator.at_least(q, -doubt).all(axis=1)]:
        yield f"a cell about {_shown(place)} is not free"
    q = ordered(beside, base)
    q = q[evaluator.at_least(q, doubt).all(axis=1)]
    for place in q[cells.numbered(region.problem, q) < 0]:
        yield f"{_shown(place)} is free and in no cell"


def _edges(region: Region) -> tuple[list[str], list[str]]:
    """Return places where cells are parted although they are free, and joined although they touch.

    An edge that two cells share is looked at on its line and on both sides of it, because only what
    is free on both sides tells something.
    """
    cells, evaluator = region.cells, region.problem.evaluator
    unit, lift_unit = cells.curves.scale
    count, room = len(cells.span), WIDE * lift_unit
    ends = cells.ends.swapaxes(0, 1).reshape(-1, 2)  # where cells start, then where they end
    v = ends[:, :1] + np.diff(ends) * ACROSS
    t = cells.lines[cells.span.T].reshape(-1, 1)
    q = ordered(np.stack(np.broadcast_arrays(t, v), axis=-1), region.base)
    free = np.asarray(evaluator.at_least(q, ROOMY * evaluator.sizes).all(axis=-1))
    k, n = np.nonzero(free & (np.diff(ends) > room))
    one, other = cells.joined.T
    owner, edge = np.append(other, count + one), np.tile(cells.edge, (2, 1))
    which, j = matches(owner, k)
    low, high = edge[j].T
    at = v[k, n]
    kept = which[(low - room < at[which]) & (at[which] < high + room)]
    parted = np.delete(q[k, n], kept, axis=0)
    wide = np.flatnonzero(np.diff(cells.edge)[:, 0] > room)
    one, other, edge = one[wide], other[wide], cells.edge[wide]
    v = edge[:, :1] + np.diff(edge) * ACROSS
    left, right = cells.spans(one), cells.spans(other)
    step = np.minimum(ASIDE * unit, np.minimum(np.ptp(left, axis=1), np.ptp(right, axis=1)) / 2)
    t = np.stack([left[:, 1] - step, left[:, 1], right[:, 0] + step])[..., None]
    q = ordered(np.stack(np.broadcast_arrays(t, v), axis=-1), region.base)
    clear = np.asarray(evaluator.at_least(q, CLEAR * evaluator.margin_rounding).all(axis=-1))
    touching = (clear[0] & clear[2]).any(axis=1) & ~clear[1].any(axis=1)
    return (
        [f"a cell ends at {_shown(place)}, which is free" for place in parted],
        [f"cells are joined at {_shown(place)}, where bodies touch" for place in q[1, touching, 0]],
    )


def _grazes(region: Region) -> Iterator[str]:
    """Yield places inside cells where bodies touch, on curves along which a form only touches zero.

    Nothing is violated beside such a curve, so no other check sees that it parts a cell. Points and
    segments without clearance may touch.
    """
    cells, evaluator, curves = region.cells, region.problem.evaluator, region.cells.curves
    if not len(cells.span):
        return
    contacts = region.problem.contacts
    walls = {contacts.boundaries[p] for p in contacts.pair[contacts.touching].tolist()}
    counted = ~np.isin(evaluator.names, [*({*contacts.boundaries} - walls)])
    found = [np.zeros((0, 2))]
    for along in (0, 1):  # the joint along which a form has a double root
        low, high = cells.range[along]
        tables = curves.table if along else curves.table.swapaxes(1, 2)
        other = cells.range[1 - along, 0] + np.ptp(cells.range[1 - along]) * SPREAD[:, 0]
        x = basis(curves.turns[1 - along], other / curves.scale[1 - along])
        c = np.einsum("in,kij->jkn", x[:, :FEW], tables)
        size = np.abs(c).sum(axis=0)
        double = np.abs(fold(c, curves.turns[along])) <= GRAZING * size * size
        bent = np.abs(c[1:]).max(axis=0) if curves.turns[along] else np.abs(c[2])
        k = np.flatnonzero((double & (bent > GRAZING * size)).all(axis=1))
        if not len(k):
            continue
        c = np.einsum("in,kij->jkn", x, tables[k])
        only = np.ones((1, 1), dtype=np.bool_)
        root = lift_roots(curves.turns[along], c, only)[0] * curves.scale[along]
        if curves.turns[along]:
            turns = range(int((high - low) / TURN) + 1)
            root = np.concatenate([low + (root - low) % TURN + TURN * n for n in turns])
        own = np.stack(np.broadcast_arrays(other, root), axis=-1)
        found.append((own if along else own[..., ::-1]).reshape(-1, 2))
    places = np.concatenate(found)
    q = ordered(places, region.base)
    doubt = CLEAR * evaluator.margin_rounding
    clear, held = (evaluator.at_least(q, x)[:, counted].all(axis=1) for x in (doubt, -doubt))
    for place in places[~clear & held]:
        if cells.surround(place, WIDE):
            at = _shown(ordered(place, region.base))
            yield f"a cell goes on over {at}, where bodies touch"


def _parts(region: Region) -> Iterator[str]:
    """Yield the components that are not what joined cells are, and vertices off the arcs."""
    cells, span = region.cells, region.cells.span.tolist()
    pairs = cells.joined.tolist()
    if cells.round[1]:
        above, below = (np.flatnonzero(cells.row[:, e] == end) for e, end in ((1, HIGH), (0, LOW)))
        over = ((a, b) for a in above.tolist() for b in below.tolist())
        pairs += [
            (a, b) for a, b in over if max(span[a][0], span[b][0]) < min(span[a][1], span[b][1])
        ]
    first = list(range(len(span)))
    for pair in pairs:
        a, b = (first_of(first, k) for k in pair)
        first[max(a, b)] = min(a, b)
    owner = cells.owner.tolist()
    groups = [owner[k] for k in range(len(span)) if first[k] == k]
    split = any(owner[a] != owner[b] for a, b in pairs)
    if split or sorted(groups) != list(range(len(region.outlined))):
        yield f"{len(groups)} groups of joined cells are {len(region.outlined)} components"
    for k, part in enumerate(region.outlined):
        starts = {tuple(arc.start.tolist()) for arc in chain(*part.loops)}
        for vertex in part.vertices:
            if tuple(vertex.q.tolist()) not in starts:
                yield f"component {k} has a vertex where no arc starts, {_shown(vertex.q)}"


def _areas(region: Region) -> Iterator[str]:
    """Yield the components within whose loops there is another area than in their cells.

    The loops integrate q_1 dq_2; components that go round a joint are left out.
    """
    bounded = [k for k, p in enumerate(region.outlined) if p.loops and not any(p.wraps)]
    if not bounded:
        return
    parts = [region.outlined[k] for k in bounded]
    arcs = [[arc.pieces for arc in chain(*part.loops)] for part in parts]
    of = np.repeat(np.arange(len(parts)), [sum(map(len, own)) for own in arcs])
    q, dq = Pieces.joined([*chain(*arcs)]).nodes(24)
    middle = np.array([part.loops[0][0].start[0] for part in parts])
    found = np.bincount(of, ((q[..., 0] - middle[of, None]) * dq[..., 1]).sum(axis=1))
    size = float(np.prod(region.cells.curves.scale))
    most = [SAME_AREA * (size + region.area) + 1e-5 * part.area for part in parts]
    for n in np.flatnonzero(np.abs(found - [part.area for part in parts]) > most).tolist():
        part, start = parts[n], middle[n]

        def along(q: Floats, dq: Floats, start: float = start) -> Floats:
            return np.asarray((q[:, 0] - start) * dq[:, 1])

        area = float(integrate([*chain(*part.loops)], along))  # near a sharp bend 24 are too few
        if abs(area - part.area) > most[n]:
            own = part.area
            yield f"component {bounded[n]}: its loops have the area {area:.9g}, its cells {own:.9g}"


def _shown(q: Floats) -> str:
    return f"({q[0]:.9g}, {q[1]:.9g})"
