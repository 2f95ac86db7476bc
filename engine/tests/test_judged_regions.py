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

import numpy as np
import pytest

from cspace import load_robot
from cspace.model.robotfile import packaged_robots, parse_robot, robot_text
from cspace.region import Region, clearance_problem, solve
from engine_support import body_scenes
from engine_support.region_judge import Outline, agreement, faults, kinds, raster, read_scene

SCENES = Path(__file__).with_name("once_wrong")
HARD = Path(__file__).with_name("not_decided")
COMPONENTS = {
    "acute-10728": 1,
    "bare-segments-in-line": 2,
    "bare-walls-upright": 2,
    "corner-at-the-base": 1,
    "corner-of-a-square": 1,
    "corridor-1e-14": 1,
    "corridor-1e-20": 1,
    "edges-meet": 2,
    "far-slide": 4,
    "hair-10779": 1,
    "hair-50205": 1,
    "line-through-the-base": 1,
    "near-roots-102839": 2,
    "slide-20": 1,
    "slide-20-scaled": 1,
    "slide-on-edge": 2,
    "slide-on-line": 4,
    "slides": 2,
    "slit-118": 1,
    "slit-264": 1,
    "slit-80": 2,
    "sliver-12738": 3,
    "star": 1,
    "thin-wall": 2,
    "tie-75": 1,
    "triangle-1e-12": 1,
    "two-turns": 1,
    "wedge-at-the-base": 1,
    "whole-10155": 6,
    "whole-10832": 5,
    "whole-12314": 6,
    "whole-22796": 4,
}
"""Files once wrong, undecided or without an end, and how many components they have.

Of `slides` the second lies in a corner behind a post that touches the end of a range.
"""

AS_WRITTEN = {"corridor-1e-14", "corridor-1e-20", "hair-10779", "sliver-12738", "triangle-1e-12"}
"""Of these the decimals are asked for: doubles would round their hair away."""

PATIENCE = 120.0
"""Seconds after which a search is taken for one without an end: a guard, not a measurement."""

BLOCK = 20
SUITE = [seed for seed in range(306) if seed % 50 != 49]
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
    text: str, *, flooded: bool = False, decimals: bool = False, components: int | None = None
) -> list[str]:
    """What the judge finds over either joint, and between both; or another count of components."""
    try:
        regions = regions_of(text, decimals=decimals)
    except TimeoutError as error:
        return [str(error)]
    found = agreement([Outline.of(region) for region in regions])
    counts = [len(region.components) for region in regions]
    if components is not None and counts != [components] * 2:
        found.append(f"components: {counts} over either joint, {components} wanted")
    return found + [each for region in regions for each in faults(text, region, flooded=flooded)]


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
    """One in twenty is flooded too."""
    seeds = SUITE[block * BLOCK :][:BLOCK]
    found = {seed: wrong(body_scenes.scene(seed), flooded=seed == seeds[0]) for seed in seeds}
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


@pytest.mark.parametrize("name", COMPONENTS)
def test_a_region_that_was_once_wrong_is_right(name):
    text, decimals = (SCENES / f"{name}.toml").read_text(encoding="utf-8"), name in AS_WRITTEN
    assert not wrong(text, flooded=True, decimals=decimals, components=COMPONENTS[name])


@pytest.mark.parametrize("path", sorted(HARD.glob("*.toml")), ids=lambda path: path.stem)
def test_a_scene_on_the_edge_is_right_or_says_that_it_is_not_decided(path):
    """Discs smaller than a root of rounding, a slide between two corners: none may be wrong."""
    text = path.read_text(encoding="utf-8")
    regions = regions_of(text, decimals=True)
    decided = [region for region in regions if not region.unresolved]
    assert not [each for region in decided for each in faults(text, region, flooded=False)]
    assert len(decided) < 2 or not agreement([Outline.of(region) for region in decided])


# --- the judge ------------------------------------------------------------------------------------

PLAIN = body_scenes.scene(6)


def test_every_recorded_file_has_its_number_of_components():
    assert {path.stem for path in SCENES.glob("*.toml")} == set(COMPONENTS)


def test_the_judge_measures_as_the_library_does():
    """Where nothing overlaps: margins of the two are the same lengths."""
    for seed in (0, 3, 5, 7, 12, 18):
        text = body_scenes.scene(seed)
        scene, region = (
            read_scene(text),
            solve(clearance_problem(parse_robot(tomllib.loads(text))), base=0),
        )
        q = np.random.default_rng(seed).uniform(*scene.ends.T, (300, 2))
        margins = dict(zip(region.boundaries, region.margins(q / scene.scale).T, strict=True))
        for check in scene.checks:
            own = scene.margins(check, q)
            theirs = margins[check.name] * float(10.0**scene.places)
            assert np.allclose(own[own > 0], theirs[own > 0], rtol=0, atol=1e-12 * scene.size)
            assert (theirs[own < 0] <= 0).all()


def test_the_judge_accepts_a_right_region_and_its_copies():
    assert not wrong(PLAIN, flooded=True)
    for copy, _ in body_scenes.copies(PLAIN).values():
        assert not wrong(copy, flooded=True)


@pytest.mark.parametrize(
    ("more", "expected"), [("0.001", {"arc", "vertex"}), ("-0.001", {"arc", "infeasible"})]
)
def test_the_judge_sees_an_obstacle_that_is_a_little_larger_or_smaller(more, expected):
    """The region is that of other numbers than the file that is judged."""
    table = body_scenes.read(PLAIN)
    table["clearance"] = table.get("clearance", Decimal("0.01")) + Decimal("0.01")
    asked = body_scenes.written(table)
    table["clearance"] += Decimal(more)
    region = regions_of(body_scenes.written(table))[0]
    assert expected <= set(kinds(faults(asked, region)))


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
