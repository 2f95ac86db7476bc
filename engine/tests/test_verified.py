"""A region verifies itself: seeded faults are named, and what cannot be decided is unresolved."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.model.robotfile import parse_robot
from cspace.region import Region, clearance_problem, solve
from cspace.region import region as engine
from cspace.region.exact import UndecidedError
from cspace.region.region import UnresolvedError, faults, looked_over
from engine_support import body_scenes
from engine_support.forms import ROUND, RR, forms
from engine_support.regions import problem_of
from qbound.forms import HarmonicForm

NAMES = ["minervabot-v2", "two-links-on-a-table"]


@pytest.fixture(params=NAMES)
def region(request) -> Region:
    return find_region(load_robot(request.param))


def with_component(region: Region, k: int, **changes) -> Region:
    """The region with something of one component changed."""
    found = list(region.outlined)
    found[k] = replace(found[k], **changes)
    return replace(region, outlined=tuple(found))


def with_arc(region: Region, k: int, **pieces) -> Region:
    """The region with an arc of its first loop laid otherwise."""
    first, *others = region.outlined[0].loops
    arc = replace(first[k], pieces=replace(first[k].pieces, **pieces))
    return with_component(region, 0, loops=((*first[:k], arc, *first[k + 1 :]), *others))


def overlooking(name: str, boundary: str) -> Region:
    """The region of a robot that was solved without one of its boundaries."""
    problem = clearance_problem(load_robot(name))
    without = solve(problem.without([problem.names.index(boundary)]))
    return replace(without, problem=problem)


def moved_starts(region: Region, k: int, piece: int) -> tuple[Region, str]:
    """The region with a piece of an arc that starts elsewhere; the place as faults have it."""
    start = region.outlined[0].loops[0][k].pieces.start.copy()
    start[piece] += 1e-5
    one, other = start[piece] if region.base == 0 else start[piece][::-1]
    return with_arc(region, k, start=start), f"({one:.9g}, {other:.9g})"


# --- what is right, and what is named -------------------------------------------------------------


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", [*NAMES, "pp-portal", "rp-telescopic-boom", "pr-gantry-arm"])
def test_a_right_region_has_no_faults(name, base):
    assert faults(solve(clearance_problem(load_robot(name)), base=base)) == []


def test_an_arc_of_another_boundary_is_named(region):
    first, *others = region.outlined[0].loops
    wrong = next(name for name in region.boundaries if name != first[0].boundary)
    loop = (replace(first[0], boundary=wrong), *first[1:])
    found = faults(with_component(region, 0, loops=(loop, *others)))
    assert found
    assert found[0].startswith(f"an arc of {wrong} is ")


def test_an_arc_that_leaves_its_curve_for_another_one_of_its_boundary_is_named():
    """A wall of scene 6 is tilted by 2.8e-17: one loop jumped along it once."""
    region = solve(clearance_problem(parse_robot(tomllib.loads(body_scenes.scene(6)))), base=0)
    (n, loop) = next((n, x) for n, x in enumerate(region.outlined[0].loops) if len(x) > 1)
    k = next(k for k, arc in enumerate(loop) if arc.label == ("fore, o0", "edge 1 on corner 0"))
    after = loop[k + 1]
    assert (loop[k - 1].boundary, after.boundary) == ("fore, o0", "fore, o0")
    start = after.pieces.start.copy()
    start[0] = loop[k].pieces.start[0]
    arcs = (*loop[:k], replace(after, pieces=replace(after.pieces, start=start)), *loop[k + 2 :])
    loops = (*region.outlined[0].loops[:n], arcs, *region.outlined[0].loops[n + 1 :])
    assert faults(region) == []
    found = faults(with_component(region, 0, loops=loops))
    assert any(fault.startswith("an arc of fore, o0 leaves its curve at (") for fault in found)


def test_a_vertex_or_a_joint_of_two_pieces_that_is_moved_is_named_with_its_place(region):
    arcs = region.outlined[0].loops[0]
    starts = [(k, n) for k, arc in enumerate(arcs) for n in range(len(arc.pieces))]
    assert any(n > 0 for _, n in starts)
    for k, n in starts:
        moved, place = moved_starts(region, k, n)
        named = [fault for fault in faults(moved) if fault.endswith(place)]
        assert any(fault.startswith(f"an arc of {arcs[k].boundary} ") for fault in named)


@pytest.mark.parametrize("name", ["minervabot-v2", "pp-portal"])
def test_a_loop_that_is_lost_or_there_twice_is_named(name):
    region = find_region(load_robot(name))
    loops = region.outlined[0].loops
    assert faults(with_component(region, 0, loops=loops[1:]))
    (found,) = faults(with_component(region, 0, loops=(*loops, loops[0])))
    assert found.startswith("component 0: its loops have the area ")


def test_two_components_as_one_are_named(region):
    """With the arcs and the area of both, and with their cells, too."""
    one, other, *rest = region.outlined
    both = (replace(one, area=one.area + other.area, loops=one.loops + other.loops), *rest)
    cells = replace(region.cells, owner=np.maximum(region.cells.owner - 1, 0))
    for own in (region.cells, cells):
        found = faults(replace(region, outlined=both, cells=own))
        n = len(region.outlined)
        assert f"{n} groups of joined cells are {n - 1} components" in found


OVERLOOKED = [("minervabot-v2", "B7", "cell"), ("pp-portal", "table", "cell")]
OVERLOOKED += [("pp-portal", "camera, bottle", "cell")]
OVERLOOKED += [
    ("pp-portal", each, "arc") for each in ("chute", "gripper, crate", "gripper, bottle")
]


@pytest.mark.parametrize(("name", "boundary", "seen"), OVERLOOKED)
def test_a_cell_or_an_arc_where_a_boundary_is_violated_is_named(name, boundary, seen):
    """A boundary was overlooked: the region is that without it."""
    found = faults(overlooking(name, boundary))
    cells = [fault for fault in found if fault.startswith("a cell about (")]
    arcs = [fault for fault in found if f"runs where {boundary} is violated, at (" in fault]
    assert arcs if seen == "arc" else cells
    assert all(fault.endswith("is not free") for fault in cells)
    assert {*found} == {*cells, *arcs}


@pytest.mark.parametrize("more", [1e-6, 1e-3])
def test_a_boundary_that_keeps_more_than_it_is_asked_is_named(more):
    problem = clearance_problem(load_robot("pp-portal"))
    grown = problem.forms.coefficients.copy()
    grown[:, 0, 0] -= more * np.abs(grown).max(axis=(1, 2))
    forms = HarmonicForm(grown, problem.forms.kinds)
    found = faults(replace(solve(replace(problem, forms=forms, origins=())), problem=problem))
    assert any(fault.startswith("an arc of camera, crate is ") for fault in found)


@pytest.mark.parametrize("part", ["row", "slope"])
def test_a_cell_with_an_end_that_is_not_its_own_is_named(region, part):
    cells = region.cells
    wrong = np.roll(cells.row, 1, axis=0) if part == "row" else -cells.slope
    found = faults(replace(region, cells=replace(cells, **{part: wrong})))
    assert any(fault.startswith("a cell about (") for fault in found)


def test_cells_that_end_beside_the_fibre_that_bounds_them_are_named():
    """cos q1 > 0 is bounded by two whole fibres."""
    region = solve(problem_of(forms(RR, {"10": 1}), ROUND), base=0)
    assert faults(region) == []
    for off in (0.1, -0.1):
        cells = replace(region.cells, lines=region.cells.lines + off)
        assert any("is not free" in fault for fault in faults(replace(region, cells=cells)))


def test_cells_that_are_parted_by_nothing_are_named(region):
    cells = region.cells
    apart = replace(cells, joined=cells.joined[:0], edge=cells.edge[:0])
    found = faults(replace(region, cells=apart))
    assert any(fault.startswith("a cell ends at (") for fault in found)


@pytest.mark.parametrize("drop", [0, 5, 11])
@pytest.mark.parametrize("name", NAMES)
def test_a_region_without_one_of_its_cells_is_not_handed_out(monkeypatch, name, drop):
    whole = engine.find_cells

    def fewer(scene):
        found = whole(scene)
        kept = np.arange(len(found.span)) != drop
        rows = {key: getattr(found, key)[kept] for key in ("span", "roots", "rank", "ends")}
        return replace(found, **rows)

    monkeypatch.setattr(engine, "find_cells", fewer)
    assert find_region(load_robot(name)).unresolved


# --- unresolved -----------------------------------------------------------------------------------


@pytest.fixture
def unresolved(monkeypatch) -> Region:
    monkeypatch.setattr(engine, "looked_over", lambda region: (["a seeded fault"], []))
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


def test_a_region_that_is_right_over_one_joint_only_is_that_one(monkeypatch):
    whole = engine.find_cells

    def half(scene):
        if scene.base == 0:
            raise UndecidedError("not over this joint")
        return whole(scene)

    expected = find_region(load_robot("minervabot-v2"))
    monkeypatch.setattr(engine, "find_cells", half)
    region = find_region(load_robot("minervabot-v2"))
    assert region.base == 1
    assert not region.unresolved
    assert region.area == pytest.approx(expected.area, rel=1e-12)


def test_one_that_is_wrong_is_found_again_with_more_asked_of_exact_numbers(monkeypatch):
    asked = []
    scene_of = engine.scene_of

    def seen(*given):
        scene = scene_of(*given)
        asked.append(scene.eps.max())
        return scene

    def once(region):
        return (["wrong"], []) if len(asked) == 1 else looked_over(region)

    monkeypatch.setattr(engine, "scene_of", seen)
    monkeypatch.setattr(engine, "looked_over", once)
    region = find_region(load_robot("minervabot-v2"))
    assert not region.unresolved
    assert asked == [asked[0], engine.CAUTION * asked[0]]


def test_one_in_doubt_is_handed_out_if_it_is_the_same_over_both_joints(monkeypatch):
    monkeypatch.setattr(engine, "looked_over", lambda region: ([], ["bodies touch"]))
    assert len(find_region(load_robot("minervabot-v2")).components) == 5


def test_regions_in_doubt_that_differ_between_the_joints_are_unresolved(monkeypatch):
    built = engine._over

    def fewer(problem, home, base, caution=1.0):
        region = built(problem, home, base, caution)
        return replace(region, outlined=region.outlined[: 5 - base])

    monkeypatch.setattr(engine, "_over", fewer)
    monkeypatch.setattr(engine, "looked_over", lambda region: ([], ["bodies touch"]))
    assert find_region(load_robot("minervabot-v2")).unresolved == ("bodies touch",)
