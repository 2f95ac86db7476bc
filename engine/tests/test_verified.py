"""A region verifies itself: seeded faults are named, and what cannot be decided is unresolved."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.region import Problem, Region, clearance_problem, solve
from cspace.region import region as engine
from cspace.region.plane import UndecidedError
from cspace.region.region import UnresolvedError, faults
from engine_support.forms import ROUND, RR, forms
from engine_support.regions import problem_of
from qbound.forms import HarmonicForm

NAMES = ["minervabot-v2", "two-links-on-a-table"]
FREE = [0.2, -0.5]
HIT = [1.5, 0.0]


@pytest.fixture(params=NAMES)
def region(request) -> Region:
    return find_region(load_robot(request.param))


def with_component(region: Region, k: int, **changes) -> Region:
    """The region with something of one component changed."""
    found = list(region.outlined)
    found[k] = replace(found[k], **changes)
    return replace(region, outlined=tuple(found))


def with_arc(region: Region, **laid) -> Region:
    """The region with its first arc of a boundary laid otherwise."""
    first, *others = region.outlined[0].loops
    k = next(k for k, arc in enumerate(first) if arc.form is not None)
    arc = replace(first[k], laid=replace(first[k].laid, **laid))
    return with_component(region, 0, loops=((*first[:k], arc, *first[k + 1 :]), *others))


def overlooking(name: str, boundary: str) -> Region:
    """The region of a robot that was solved without one of its boundaries."""
    problem = clearance_problem(load_robot(name))
    without = solve(problem.without([problem.names.index(boundary)]))
    return replace(without, problem=problem)


def first_arc(region: Region):
    return next(arc for arc in region.outlined[0].loops[0] if arc.form is not None)


# --- what is right, and what is named -------------------------------------------------------------


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", [*NAMES, "pp-portal", "rp-telescopic-boom", "pr-gantry-arm"])
def test_a_right_region_has_no_faults(name, base):
    assert faults(solve(clearance_problem(load_robot(name)), base=base)) == []


def test_an_arc_that_is_moved_is_named(region):
    arc = first_arc(region)
    found = faults(with_arc(region, turns=arc.laid.turns + 1e-5))
    assert found
    assert found[0].startswith(f"an arc of {arc.boundary} is ")


def test_an_arc_of_another_boundary_is_named(region):
    first, *others = region.outlined[0].loops
    wrong = next(name for name in region.boundaries if name != first[0].boundary)
    loop = (replace(first[0], boundary=wrong), *first[1:])
    found = faults(with_component(region, 0, loops=(loop, *others)))
    assert found
    assert found[0].startswith(f"an arc of {wrong} is ")


def test_a_vertex_that_is_moved_is_named_with_its_place(region):
    arc = first_arc(region)
    start = arc.laid.start.copy()
    start[arc.span[0]] += 1e-5
    found = faults(with_arc(region, start=start))
    moved = start[arc.span[0]] if region.base == 0 else start[arc.span[0]][::-1]
    place = f"({moved[0]:.9g}, {moved[1]:.9g})"
    assert any(f.startswith(f"an arc of {arc.boundary} is ") and f.endswith(place) for f in found)


def test_a_joint_of_two_pieces_that_is_moved_is_named(region):
    """Inside an arc, where no vertex is."""
    arcs = [arc for part in region.outlined for loop in part.loops for arc in loop]
    joints = [arc.span[1] - 1 for arc in arcs if arc.form is not None and np.ptp(arc.span) > 2]
    assert joints
    for joint in joints:
        start = arcs[0].laid.start.copy()
        start[joint] += 1e-5
        first, *others = region.outlined[0].loops
        arc = replace(first[0], laid=replace(first[0].laid, start=start))
        found = faults(with_component(region, 0, loops=((arc, *first[1:]), *others)))
        moved = start[joint] if region.base == 0 else start[joint][::-1]
        place = f"({moved[0]:.9g}, {moved[1]:.9g})"
        assert any(fault.endswith(place) for fault in found)


def test_a_loop_that_is_lost_or_there_twice_is_named(region):
    loops = region.outlined[0].loops
    n = len(loops)
    for wrong in (loops[1:], (*loops, loops[0])):
        found = faults(with_component(region, 0, loops=wrong))
        assert f"component 0 has {len(wrong)} loops, not {n}" in found


def test_two_components_as_one_are_named(region):
    """With the cells of both, too."""
    one, other, *rest = region.outlined
    both = (replace(one, area=one.area + other.area, loops=one.loops + other.loops), *rest)
    owner = {cell: max(k - 1, 0) for cell, k in region.owner.items()}
    for owners in (region.owner, owner):
        found = faults(replace(region, outlined=both, owner=owners))
        assert any(fault.startswith("component 0 has ") for fault in found)


OVERLOOKED = [("minervabot-v2", "B7"), ("pp-portal", "table"), ("pp-portal", "camera, bottle")]


@pytest.mark.parametrize(("name", "boundary"), OVERLOOKED)
def test_a_cell_in_which_a_boundary_is_violated_is_named(name, boundary):
    """A boundary was overlooked: the region is that without it."""
    found = faults(overlooking(name, boundary))
    cells = [fault for fault in found if fault.startswith("a cell about (")]
    assert cells
    assert all(fault.endswith("is not free") for fault in cells)
    assert all(f"runs where {boundary} is violated" in fault for fault in {*found} - {*cells})


@pytest.mark.parametrize("boundary", ["chute", "gripper, crate", "gripper, bottle"])
def test_an_arc_that_runs_where_another_boundary_is_violated_is_named(boundary):
    found = faults(overlooking("pp-portal", boundary))
    assert any(f"runs where {boundary} is violated, at (" in fault for fault in found)


@pytest.mark.parametrize("more", [1e-6, 1e-3])
def test_a_boundary_that_keeps_more_than_it_is_asked_is_named(more):
    problem = clearance_problem(load_robot("pp-portal"))
    grown = problem.forms.coefficients.copy()
    grown[:, 0, 0] -= more * np.abs(grown).max(axis=(1, 2))
    forms = HarmonicForm(grown, problem.forms.kinds)
    found = faults(replace(solve(replace(problem, forms=forms, origins=())), problem=problem))
    assert any(fault.startswith("an arc of camera, crate is ") for fault in found)


def test_an_end_of_a_cell_beyond_which_its_boundary_is_kept_is_named(region):
    """Ends that are those of one boundary bear the name of another one."""
    cells = copy(region.cells)
    names = cells.decomposition.names
    used = [rows for rows in names if rows[0] >= 0]
    wrong = [used[(used.index(own) + 1) % len(used)] if own in used else own for own in names]
    cells.decomposition = replace(cells.decomposition, names=wrong)
    found = faults(replace(region, cells=cells))
    assert any(fault.startswith("beyond a cell's end at (") for fault in found)


@pytest.mark.parametrize("base", [0, 1])
def test_what_stands_on_a_fibre_and_is_not_there_is_named(base):
    """cos q1 > 0 is bounded by a whole fibre, or by two ends of one cell."""
    region = solve(problem_of(forms(RR, {"10": 1}), ROUND), base=base)
    assert faults(region) == []
    cells = copy(region.cells)
    cells.decomposition = replace(cells.decomposition, standing={}, names=[()])
    found = faults(replace(region, cells=cells))
    assert found
    kind = "nothing bounds a cell at (" if base == 0 else "beyond a cell's end at ("
    assert all(fault.startswith(kind) for fault in found)


def test_cells_of_a_component_that_is_lost_are_named(region):
    last = len(region.outlined) - 1
    owner = {cell: k for cell, k in region.owner.items() if k != last}
    found = faults(replace(region, outlined=region.outlined[:-1], owner=owner))
    assert "a cell is in no component" in found


def test_cells_that_are_parted_by_nothing_do_not_add_up(region):
    cells = copy(region.cells)
    cells.elements = replace(cells.elements, joined=np.zeros_like(cells.elements.joined))
    found = faults(replace(region, cells=cells))
    assert {fault.split(" has ")[0] for fault in found} == {
        f"component {k}" for k in range(len(region.outlined))
    }


@pytest.mark.parametrize("drop", [0, 5, 11])
@pytest.mark.parametrize("name", NAMES)
def test_a_region_without_one_of_its_cells_is_not_handed_out(monkeypatch, name, drop):
    whole = engine.find_cells

    def fewer(lines, pieces):
        found = whole(lines, pieces)
        kept = np.arange(len(found.slabs)) != drop
        rows = {key: getattr(found, key)[kept] for key in ("slabs", "roots", "sets")}
        return replace(found, **rows)

    monkeypatch.setattr(engine, "find_cells", fewer)
    assert find_region(load_robot(name)).unresolved


# --- unresolved -----------------------------------------------------------------------------------


@pytest.fixture
def unresolved(monkeypatch) -> Region:
    monkeypatch.setattr(engine, "faults", lambda region: ["a seeded fault"])
    return find_region(load_robot("minervabot-v2"))


def test_what_rests_on_structure_raises_where_it_is_unresolved(unresolved):
    assert unresolved.unresolved
    assert {*unresolved.unresolved} == {"a seeded fault"}
    for ask in (
        lambda: unresolved.components,
        lambda: unresolved.has_home,
        lambda: unresolved.home_component,
        lambda: unresolved.area,
        unresolved.to_geojson,
        lambda: [component.vertices for component in unresolved.components],
    ):
        with pytest.raises(UnresolvedError, match="a seeded fault"):
            ask()
    document = unresolved.to_dict()
    assert document["components"] == []
    assert document["feasible_area"] is None
    assert {*document["unresolved"]} == {"a seeded fault"}
    assert repr(unresolved) == "<Region of MinervaBotV2: unresolved: a seeded fault>"


def test_margins_and_feasibility_are_told_where_structure_is_unresolved(unresolved, monkeypatch):
    monkeypatch.undo()
    right = find_region(load_robot("minervabot-v2"))
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, 2))
    assert (unresolved.contains(q) == right.contains(q)).all()
    assert (unresolved.margins(q) == right.margins(q)).all()
    assert unresolved.contains([FREE, HIT]).tolist() == [True, False]
    assert unresolved.boundaries == right.boundaries


def test_what_could_not_be_decided_is_told_with_its_place(monkeypatch):
    def undecided(lines, pieces):
        raise UndecidedError("two lines near base value 0.25")

    monkeypatch.setattr(engine, "find_cells", undecided)
    region = find_region(load_robot("minervabot-v2"))
    with pytest.raises(UnresolvedError, match=r"two lines near base value 0\.25"):
        _ = region.components


def test_a_region_that_is_right_over_one_joint_only_is_that_one(monkeypatch):
    whole = engine.find_cells

    def half(lines, pieces):
        if lines.finder.plane.base == 0:
            raise UndecidedError("not over this joint")
        return whole(lines, pieces)

    expected = find_region(load_robot("minervabot-v2"))
    monkeypatch.setattr(engine, "find_cells", half)
    region = find_region(load_robot("minervabot-v2"))
    assert region.base == 1
    assert not region.unresolved
    assert region.area == pytest.approx(expected.area, rel=1e-12)


def test_one_that_is_wrong_in_doubles_is_computed_again_with_more_in_balls(monkeypatch):
    asked = []

    def once(region):
        asked.append(region.cells.plane.caution)
        return ["wrong"] if len(asked) == 1 else faults(region)

    monkeypatch.setattr(engine, "faults", once)
    region = find_region(load_robot("minervabot-v2"))
    assert not region.unresolved
    assert asked[:2] == list(engine.CAUTION)


def test_regions_that_differ_between_the_joints_are_unresolved(monkeypatch):
    """A component is lost over one joint of a delicate problem."""
    built = engine._over

    def fewer(problem, home, base, caution):
        region = built(problem, home, base, caution)
        return replace(region, outlined=region.outlined[: 5 - base])

    monkeypatch.setattr(engine, "_over", fewer)
    monkeypatch.setattr(engine, "_is_delicate", lambda region: True)
    monkeypatch.setattr(engine, "faults", lambda region: [])
    region = find_region(load_robot("minervabot-v2"))
    assert "5 components over one joint, 4 over the other" in region.unresolved


def test_a_problem_of_forms_may_be_unresolved_too(monkeypatch):
    monkeypatch.setattr(engine, "faults", lambda region: ["a seeded fault"])
    problem = clearance_problem(load_robot("pp-portal"))
    bare = Problem(problem.forms, problem.names, problem.ranges, problem.limits)
    region = solve(bare)
    assert repr(region) == "<Region: unresolved: a seeded fault>"
    with pytest.raises(UnresolvedError):
        _ = region.components


# --- what a region does not see of itself yet -----------------------------------------------------


def test_a_component_that_is_lost_is_named(region):
    assert faults(replace(region, outlined=region.outlined[:-1]))


def test_a_vertex_that_is_not_where_its_arc_starts_is_named(region):
    first, *others = region.outlined[0].vertices
    moved = replace(first, q=first.q + 1e-3)
    assert faults(with_component(region, 0, vertices=(moved, *others)))


def test_what_stands_alone_on_a_line_needs_no_balls():
    """The walls of one joint of the paper's robot; balls would ask for the other joint, too."""
    region = find_region(load_robot("minervabot-v2"))
    assert region.cells.decomposition.precise.decided == 0
