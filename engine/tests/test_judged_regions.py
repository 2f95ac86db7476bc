"""Regions of bodies beside a judge of its own: 300 scenes, copies of some, and those once wrong.

`engine/benchmarks/judged.py` asks the same of thousands, and of other processors' machine code.
"""

import signal
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.model.robotfile import packaged_robots, parse_robot, robot_text
from cspace.region import Region, clearance_problem, solve
from cspace.region.arcs import ordered
from cspace.region.region import looked_over
from engine_support import body_scenes
from engine_support.region_judge import (
    Gap,
    Outline,
    agreement,
    faults,
    kinds,
    misplaced,
    raster,
    read_scene,
)

SCENES = Path(__file__).with_name("once_wrong")
COMPONENTS = {
    "acute-10728": 1,
    "amplitude-1e-16": 2,
    "at-the-pivot-1e-10": 3,
    "bare-segments-in-line": 2,
    "bare-telescope": 1,
    "bare-walls-upright": 2,
    "capsule-1e-14": 1,
    "corner-at-the-base": 1,
    "corner-of-a-square": 1,
    "corridor-1e-13": 1,
    "corridor-1e-14": 1,
    "corridor-1e-20": 1,
    "disc-1e14": 1,
    "disc-at-the-cut": 1,
    "edges-meet": 2,
    "far-slide": 4,
    "far-triangle": 1,
    "floor-at-a-limit": 2,
    "floor-at-half-a-turn": 2,
    "hair-10779": 1,
    "hair-50205": 1,
    "line-through-the-base": 1,
    "lines-1e-38-apart": 3,
    "longer-by-1e-9": 1,
    "mount-and-segment": 1,
    "mount-of-1-degree": 1,
    "mounts-of-30-degrees": 1,
    "near-roots-102839": 2,
    "point-at-a-pivot": 0,
    "point-at-an-end": 0,
    "point-in-line": 1,
    "point-on-a-pivot": 1,
    "root-below-the-lift": 1,
    "slide-20": 1,
    "slide-20-scaled": 1,
    "slide-along-a-segment": 1,
    "slide-on-edge": 2,
    "slide-on-line": 4,
    "slide-to-a-corner": 3,
    "slides": 2,
    "slit-118": 1,
    "slit-264": 1,
    "slit-80": 2,
    "slit-and-round": 1,
    "sliver-12738": 3,
    "small-at-the-cut": 1,
    "small-disc-at-a-fold": 2,
    "spike-3e-12": 2,
    "star": 1,
    "stretched": 5,
    "thin-disc": 1,
    "thin-wall": 2,
    "three-in-one-point": 1,
    "tie-75": 1,
    "triangle-1e-12": 1,
    "two-handovers-on-a-line": 1,
    "two-turns": 1,
    "two-turns-by-a-hair": 2,
    "upright-edge-1e-9": 2,
    "walls-1e-21": 1,
    "walls-parallel": 1,
    "wedge-at-the-base": 1,
    "whole-10155": 6,
    "whole-10832": 5,
    "whole-12314": 6,
    "whole-22796": 4,
}
"""Files once wrong, undecided or without an end, and how many components they have.

Of `slides` the second lies in a corner behind a post that touches the end of a range.
"""

AS_WRITTEN = {
    "amplitude-1e-16",
    "at-the-pivot-1e-10",
    "bare-telescope",
    "capsule-1e-14",
    "corridor-1e-14",
    "corridor-1e-20",
    "disc-at-the-cut",
    "floor-at-half-a-turn",
    "hair-10779",
    "lines-1e-38-apart",
    "longer-by-1e-9",
    "root-below-the-lift",
    "slide-to-a-corner",
    "sliver-12738",
    "small-at-the-cut",
    "small-disc-at-a-fold",
    "triangle-1e-12",
    "two-turns-by-a-hair",
    "walls-parallel",
}
"""Of these the decimals are asked for: doubles would round their hair away."""

AGAIN = [18, 78, 616, 697, 919, 997, 1015, 11537, 11756, 15654, 20672, 64375]
"""Scenes by seed whose decimals were once wrong, or undecided over one of the joints."""

PATIENCE = 120.0
"""Seconds after which a search is taken for one without an end: a guard, not a measurement."""

BLOCK = 20
SUITE = [seed for seed in range(163) if seed % 50 != 49]
"""Without those of 100 obstacles, which take seconds."""


def regions_of(text: str, *, decimals: bool = False) -> list[Region]:
    """The region over each joint: of a text's doubles, or of its decimals as they are written."""
    problem = clearance_problem(parse_robot(text if decimals else tomllib.loads(text)))
    with within(PATIENCE):
        return [solve(problem, base=base) for base in (0, 1)]


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Stop what takes longer, in processor time, where the system has such a clock."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(*_: object) -> None:
        raise TimeoutError(f"no region after {seconds} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def wrong(
    text: str,
    *,
    flooded: bool = False,
    placed: bool = False,
    decimals: bool = False,
    components: int | None = None,
) -> list[str]:
    """What the judge finds over either joint, and between both; or another count of components."""
    try:
        regions = regions_of(text, decimals=decimals)
    except TimeoutError as error:
        return [str(error)]
    found = agreement([Outline.of(region) for region in regions])
    if [region.base for region in regions] != [0, 1]:
        found.append("base: one joint's region is found over the other")
    counts = [len(region.components) for region in regions]
    if components is not None and counts != [components] * 2:
        found.append(f"components: {counts} over either joint, {components} wanted")
    judged = (faults(text, region, flooded=flooded, placed=placed) for region in regions)
    return found + [each for own in judged for each in own]


# --- the library ----------------------------------------------------------------------------------

TWO_JOINTS = [name for name in packaged_robots() if len(load_robot(name).joints) == 2]


FINE = 4096
"""Cells of a range: the robot of the paper has two components that 1024 do not tell apart."""


@pytest.mark.parametrize("name", TWO_JOINTS)
def test_the_judge_finds_nothing_wrong_with_a_packaged_robot(name):
    """Its components too, by a flood of cells: nothing else is a second opinion on the engine."""
    text, _ = robot_text(name)
    regions = regions_of(text, decimals=True)
    assert agreement([Outline.of(region) for region in regions]) == []
    assert [faults(text, region, finest=FINE) for region in regions] == [[], []]


def test_the_judge_sees_that_the_robot_of_the_paper_lost_a_component_or_has_two_in_one():
    text, _ = robot_text("minervabot-v2")
    for region in regions_of(text, decimals=True):
        one, other, *more = region.components
        assert faults(text, replace(region, outlined=(one, *more))) != []
        merged = replace(one, area=one.area + other.area, loops=one.loops + other.loops)
        cells = replace(region.cells, owner=np.maximum(region.cells.owner - 1, 0))
        both = replace(region, outlined=(merged, *more), cells=cells)
        assert kinds(faults(text, both, finest=FINE)) == ["merged"]


@pytest.mark.parametrize("block", range(len(SUITE) // BLOCK))
def test_regions_over_both_joints_agree_and_their_arcs_lie_on_their_boundaries(block):
    """One in twenty is flooded too; of one in ten random configurations are asked for."""
    seeds = SUITE[block * BLOCK :][:BLOCK]
    found = {
        seed: wrong(body_scenes.scene(seed), flooded=seed == seeds[0], placed=seed % 10 == 3)
        for seed in seeds
    }
    assert not {seed: each[:3] for seed, each in found.items() if each}


@pytest.mark.parametrize("seed", [0, 2, 6, 12, 16, 17, 19, 38])
def test_exact_copies_of_a_scene_have_the_same_region(seed):
    text = body_scenes.scene(seed)
    slides = sum(joint["type"] == "prismatic" for joint in body_scenes.read(text)["joint"])
    own = [Outline.of(region) for region in regions_of(text, decimals=True)]
    for name, (copy, places) in body_scenes.copies(text).items():
        again = [Outline.of(region) for region in regions_of(copy, decimals=True)]
        factor = float(10.0 ** (places * slides))
        assert not agreement([*own, *again], [1.0, 1.0, factor, factor]), name


def test_lengths_of_1e17_leave_a_slope_its_part():
    """Of a half-space of two slides: its normal's numbers stay near 1."""
    assert not wrong(body_scenes.shifted(body_scenes.scene(60004), 9), decimals=True)


@pytest.mark.parametrize("seed", [352, 452])
def test_limits_beside_quarter_turns_are_those_of_the_file(seed):
    """In radians: one of a turn in doubles only, and one beside a fold."""
    copy, _ = body_scenes.copies(body_scenes.scene(seed))["mirrored"]
    assert not wrong(copy, decimals=True)


@pytest.mark.parametrize("name", COMPONENTS)
def test_a_region_that_was_once_wrong_is_right(name):
    text, decimals = (SCENES / f"{name}.toml").read_text(encoding="utf-8"), name in AS_WRITTEN
    assert not wrong(text, flooded=True, decimals=decimals, components=COMPONENTS[name])


RESTING = {
    "7": [],
    "48": [],
    "95": [],
    "117": [],
    "16": [[1.0832608213156707, -1.5707963279420865]],
    "132": [[1.57079632344419, -0.3949190342588109]],
    "169": [[1.57079632434598, -1.1886775567893495]],
    "173": [[0.8651149766933801, -1.9999999756772293]],
    "268": [[0.0, 0.0]],
}
"""Bodies that slide along edges, or touch at an end of a range or in a tangent.

With configurations that stood on the wrong side of a line beside a tangent contact.
"""


@pytest.mark.parametrize("name", RESTING)
def test_bodies_that_rest_on_one_another_are_told_right_to_the_last_digits(name):
    text = (SCENES / "resting" / f"drawn-{name}.toml").read_text(encoding="utf-8")
    first, second = regions_of(text)
    assert first.area == pytest.approx(second.area, rel=0, abs=1e-11)
    for region in (first, second):
        assert not faults(text, region, flooded=False, placed=True)
        assert not misplaced(read_scene(text), region, np.reshape(RESTING[name], (-1, 2)))


@pytest.mark.parametrize("name", ["fold-at-a-limit", "limit-at-half-a-turn"])
def test_a_region_of_points_that_was_once_wrong_is_the_same_over_both_joints(name):
    problem = clearance_problem(load_robot(SCENES / "points" / f"{name}.toml"))
    one, other = (solve(problem, base=base) for base in (0, 1))
    assert (one.base, other.base) == (0, 1)
    assert one == other
    (component,) = one.components
    assert component.wraps == (False, False)
    assert len(component.vertices) == 4


def test_a_component_of_area_1e_28_is_found_over_either_joint():
    """Between a limit of the first joint and a disc that a capsule touches there."""
    text = (SCENES / "areas" / "sliver-1e-28.toml").read_text(encoding="utf-8")
    for region in regions_of(text, decimals=True):
        (component,) = region.components
        assert [len(loop) for loop in component.loops] == [3]
        assert component.area < 1e-24


@pytest.mark.parametrize("base", [0, 1])
def test_features_that_touch_1e_16_beside_their_edges_part_nothing(base):
    """The symmetric arm's bodies meet in two pairs of features at nearly one angle of a joint."""
    robot = replace(load_robot("minervabot-v2-symmetric"), boundaries=(), collisions=True)
    region = solve(clearance_problem(robot), base=base)
    assert region.base == base
    assert [len(component.vertices) for component in region.components] == [4]


@pytest.mark.parametrize("seed", AGAIN)
def test_a_scene_that_was_once_wrong_is_right_over_each_joint(seed):
    assert not wrong(body_scenes.scene(seed), flooded=True, decimals=True)


def test_the_check_doubts_a_cell_that_goes_on_over_a_wall_without_width(monkeypatch):
    """The elbow passes a disc at one angle of the first joint, whatever the second."""
    problem = clearance_problem(parse_robot(body_scenes.scene(577)))
    right = solve(problem, base=1)
    assert (right.base, looked_over(right)) == (1, ([], []))
    with monkeypatch.context() as patch:
        patch.setattr("cspace.region.exact.TOUCHES", 10**5)  # double roots are lost
        assert solve(problem, base=1).base == 0
    with monkeypatch.context() as patch:
        patch.setattr(
            "cspace.region.components._open_parts",
            lambda cells, line, one, other: [(one, other)],
        )
        assert solve(problem, base=0).base == 1


def test_the_check_sees_cells_that_are_not_joined():
    region = regions_of(body_scenes.scene(0))[0]
    cells = region.cells
    fewer = replace(cells, joined=cells.joined[1:], edge=cells.edge[1:])
    found = looked_over(replace(region, cells=fewer))[0]
    assert found
    assert any("a cell ends at" in each for each in found)


def found_in(name: str) -> Region:
    return find_region(load_robot(SCENES / f"{name}.toml"))


def test_a_link_that_is_6e_15_too_long_between_two_walls_has_a_region():
    """Its tip keeps within 1.979999999999994 m, so it stops 8e-8 rad before it stands upright."""
    region = found_in("walls-parallel")
    assert region.unresolved == ()
    (component,) = region.components
    with mpmath.workdps(40):
        steepest = mpmath.asin(mpmath.mpf("1.899999999999994") / mpmath.mpf("1.9"))
    assert component.area == pytest.approx(float(12 * steepest), rel=1e-12)


def test_arcs_about_a_tiny_disc_lie_on_its_boundary():
    region, radius = found_in("thin-disc"), 9e-8
    arcs = [a for c in region.components for loop in c.loops for a in loop if a.form is not None]
    for arc in (arc for arc in arcs if arc.boundary == "L2, o0"):
        margins = region.margins(arc.at(np.linspace(0, 1, 9)))
        column = region.boundaries.index(arc.boundary)
        assert np.abs(margins[:, column]).max() < 1e-3 * radius


def test_the_ends_of_cells_about_a_tiny_disc_are_roots_of_their_forms():
    cells = found_in("thin-disc").cells
    assert (cells.row >= len(cells.curves.table)).any()
    for k, e in np.argwhere(cells.row >= 0).tolist():
        t = cells.spans([k]).mean(axis=1)
        place = np.stack([t, cells.interval([k], t[None])[e, :, 0]], axis=-1)
        form = cells.curves.form(int(cells.row[k, e]))
        assert form(ordered(place, cells.curves.base)) == pytest.approx(0, abs=1e-12)


def test_no_arc_runs_beyond_a_joint_limit():
    asked = found_in("stretched").problem
    for base in (0, 1):
        for component in solve(asked, base=base).components:
            q = np.concatenate([arc.points for loop in component.loops for arc in loop])
            for values, (low, high) in zip(q.T, asked.ranges, strict=True):
                assert low - 1e-12 <= values.min()
                assert values.max() <= high + 1e-12


# --- the judge ------------------------------------------------------------------------------------

PLAIN = body_scenes.scene(6)


def test_every_recorded_file_has_its_number_of_components():
    assert {path.stem for path in SCENES.glob("*.toml")} == set(COMPONENTS)


def test_the_judge_measures_as_the_library_does():
    """Where no cores overlap margins of the two are the same lengths; else both say so.

    At random, and in eighths of a turn or whole units.
    """
    shares = []
    for seed in [*range(8), *range(12, 20)]:
        text = body_scenes.scene(seed)
        scene, problem = read_scene(text), clearance_problem(body_scenes.robot(text))
        q = np.random.default_rng(seed).uniform(*scene.ends.T, (300, 2))
        step = np.where([each.turns for each in scene.steps], np.pi / 4, scene.size / 8)
        q = np.concatenate([q, np.round(q[:150] / step) * step])
        judged, bodies = problem.evaluator, {boundary.name for boundary in problem.bodies}
        margins = dict(zip(judged.names, judged.margins(q / scene.scale).T, strict=True))
        for check in scene.checks:
            own = scene.margins(check, q)
            theirs = margins[check.name] * float(10.0**scene.places)
            meet = -check.kept if isinstance(check, Gap) and check.name in bodies else 0.0
            apart, rounding = own > meet, 1e-12 * scene.size
            assert np.allclose(own[apart], theirs[apart], rtol=0, atol=rounding)
            assert (theirs[~apart] <= meet + rounding).all()
        shares.append((scene.worst(q, 1.0) > 0).mean())
    assert sum(0.05 < share < 0.95 for share in shares) >= len(shares) / 2


def test_the_judge_accepts_a_right_region_and_its_copies():
    assert not wrong(PLAIN, flooded=True)
    for copy, _ in body_scenes.copies(PLAIN).values():
        assert not wrong(copy, flooded=True)


@pytest.mark.parametrize(
    ("more", "expected"),
    [("0.001", {"arc", "vertex", "place"}), ("-0.001", {"arc", "infeasible", "place"})],
)
def test_the_judge_sees_an_obstacle_that_is_a_little_larger_or_smaller(more, expected):
    """The region is that of other numbers than the file that is judged."""
    table = body_scenes.read(PLAIN)
    table["clearance"] = table.get("clearance", Decimal("0.01")) + Decimal("0.01")
    asked = body_scenes.written(table)
    table["clearance"] += Decimal(more)
    region = regions_of(body_scenes.written(table))[0]
    assert expected <= set(kinds(faults(asked, region, placed=True)))


def test_the_judge_sees_components_that_are_merged_split_or_lost():
    text = (SCENES / "slit-80.toml").read_text(encoding="utf-8")
    cells = raster(read_scene(text), 1024)
    assert {-1, 0, 1} == set(np.unique(cells.state).tolist())
    found = {
        "merged": lambda q: 0,
        "split": lambda q: int(q[0] > 0),
        "lost": lambda q: None,
    }
    for kind, told in found.items():
        region = SimpleNamespace(components=(), area=37.1, component_of=told)
        assert kind in kinds(faults(text, region))


def test_the_judge_sees_a_loop_that_is_open_and_a_region_on_the_wrong_side():
    region = regions_of(PLAIN)[0]
    component = region.components[0]
    loop = max(component.loops, key=len)
    opened = replace(component, loops=(loop[1:],), vertices=())
    backwards = [
        SimpleNamespace(
            boundary=arc.boundary,
            start=arc.end,
            end=arc.start,
            at=lambda s, arc=arc: arc.at(1 - np.asarray(s)),
        )
        for arc in loop[::-1]
    ]
    turned = replace(component, loops=(tuple(backwards),), vertices=())
    for one, kind in ((opened, "open"), (turned, "left")):
        told = SimpleNamespace(components=(one,), area=region.area)
        assert kind in kinds(faults(PLAIN, told, flooded=False))


def test_a_region_that_says_it_is_unresolved_is_no_more_than_that():
    region = SimpleNamespace(unresolved=("somewhere",))
    assert faults(PLAIN, region) == ["unresolved: the region says so itself"]
    assert kinds(agreement([Outline.of(region)] * 2)) == ["unresolved"]


def test_areas_may_differ_by_a_billionth_of_their_sum():
    one = Outline(2, 2, 6, [3.0, 1.0], [[False, False], [False, True]])
    assert not agreement([one, replace(one, areas=[3.0, 1.0 + 3e-9])])
    assert kinds(agreement([one, replace(one, areas=[3.0, 1.0 + 6e-9])])) == ["areas"]
    assert kinds(agreement([one, replace(one, vertices=7)])) == ["vertices"]
    assert kinds(agreement([one, replace(one, wraps=[[False, False]] * 2)])) == ["wraps"]
    assert not agreement([one, replace(one, areas=[3e3, 1e3])], [1.0, 1e3])
