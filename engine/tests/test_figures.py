"""Figures: the data of what is drawn, degrees, labels, and the same SVG on every run."""

import html
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from itertools import combinations
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.mathtext import MathTextParser
from matplotlib.patches import Polygon
from matplotlib.text import Annotation
from numpy.testing import assert_allclose, assert_array_equal

from cspace import figures, find_region, load_robot
from cspace.figures.pictures import (
    _lines,
    _pose_panel,
    pose_picture,
)
from cspace.paths.traversal import traverse
from engine_support.oracles import packaged_table, point_seen_from
from engine_support.robots import random_robot
from qbound import window_region

MINERVA = load_robot("minervabot-v2")
SIX = window_region(MINERVA).polygon


@pytest.fixture
def ax() -> Iterator[Axes]:
    with mpl.rc_context(figures.STYLE):
        yield Figure().subplots()


def texts(artists) -> list[str]:
    return [a.get_text() for a in artists if isinstance(a, Annotation) and a.get_text()]


def test_axes_are_in_degrees_or_in_the_files_unit_at_one_scale(ax) -> None:
    figures.joint_axes(ax, MINERVA, [[-np.pi, np.pi / 2], [-np.pi / 4, np.pi]])
    assert_allclose([ax.get_xlim(), ax.get_ylim()], [[-180, 90], [-45, 180]])
    assert ax.get_aspect() == 1
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$q_{1}$ / °", "$q_{2}$ / °")
    figures.plane_axes(ax, MINERVA, [[-10, 60], [0, 80]])
    assert_allclose([ax.get_xlim(), ax.get_ylim()], [[-10, 60], [0, 80]])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$x$ / cm", "$z$ / cm")


def test_obstacles_and_round_bodies_are_drawn_in_the_arms_own_plane(ax) -> None:
    """About z: seen from above. Posts, box, triangle, then both links as capsules."""
    robot = load_robot("two-links-on-a-table")
    post, thin, box, _, arm, forearm, *_ = figures.draw_robot(ax, robot, [0.0, np.pi / 2])
    for disc, (x, y), radius in ((post, (0.5, 0.25), 0.06), (thin, (-0.2, 0.5), 0.03)):
        assert_allclose(np.linalg.norm(disc.get_xy() - [x, y], axis=1), radius, atol=1e-12)
    assert_allclose(box.get_xy()[:4], robot.obstacles[2].shape.places[:, :2])
    assert_allclose(arm.get_xy().min(axis=0), [-0.04, -0.04], atol=1e-5)
    assert_allclose(arm.get_xy().max(axis=0), [0.44, 0.04], atol=1e-5)
    assert_allclose(forearm.get_xy().max(axis=0), [0.43, 0.38], atol=1e-5)
    figures.plane_axes(ax, robot)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$x$ / m", "$y$ / m")


def test_robot_is_drawn_where_it_stands(ax) -> None:
    """Bodies, links, joints, tool and named points by 4 x 4 matrices, in the plane x, z."""
    table, q = packaged_table(), [0.4, -1.2]
    artists = figures.draw_robot(ax, MINERVA, q, points=("6", "7"))
    bodies, (spine, joints, tool, *marks) = (
        artists[:3],
        [a for a in artists if hasattr(a, "get_xdata")],
    )
    for name, mark in zip(("6", "7"), marks, strict=True):
        x, _, z = point_seen_from(table, name, "0", q)
        assert_allclose(np.ravel(mark.get_data()), [x, z], atol=1e-12)
    assert texts(artists) == ["6", "7"]
    x, _, z = point_seen_from(table, "3", "0", q)
    assert_allclose(spine.get_xydata()[-1], [x, z], atol=1e-12)
    assert_allclose(tool.get_xydata(), [[x, z]], atol=1e-12)
    assert_allclose(spine.get_xydata()[:2], [[0, 0], [0, 22.5]])
    assert_array_equal(joints.get_xydata(), spine.get_xydata()[1:-1])
    corner_9 = point_seen_from(table, "9", "0", q)
    assert_allclose(bodies[1].get_xy()[0], corner_9[[0, 2]], atol=1e-12)


def test_links_that_are_inside_each_other_are_red_and_the_picture_says_overlap() -> None:
    for q, wanted in ((MINERVA.home, 0), (np.radians([-29.9, 120.2]), 2)):
        ax = Figure().subplots()
        artists = figures.draw_robot(ax, MINERVA, q)
        faces = [artist.get_facecolor()[:3] for artist in artists if isinstance(artist, Polygon)]
        assert faces.count(mpl.colors.to_rgb(figures.OVERLAP)) == wanted
        words = [artist.get_text() for artist in artists if isinstance(artist, Annotation)]
        assert ("overlap" in words) == (wanted > 0)


def test_a_rail_is_carried_by_what_turns_it(ax) -> None:
    """The boom at 0 is level: pivot at 1.6 m, the rail from 1.2 m on; at -90° it stands upright."""
    boom = load_robot("rp-telescopic-boom")
    for angle, ends, foot in (
        (0.0, [[1.2, 1.6], [3.8, 1.6]], [1.2, 1.6]),
        (-np.pi / 2, [[0.0, 2.8], [0.0, 5.4]], [0.0, 2.8]),
    ):
        spine, _, _, rail, *_ = figures.draw_robot(ax, boom, [angle, 0.4], bodies=False)
        assert_allclose(rail.get_xydata(), ends, atol=1e-12)
        assert_allclose(spine.get_xydata()[:3], [[0, 0], [0, 1.6], foot], atol=1e-12)
        assert np.isnan(spine.get_xydata()[3]).all()  # from the foot to the carriage: the rail


def test_half_spaces_with_one_line_are_named_one_above_the_other() -> None:
    portal = load_robot("pp-portal")
    assert ["chute", "camera, chute"] in _lines(portal, (0, 2)).values()
    assert {"chute", "camera, chute", "table"} <= texts_in(pose_picture(portal, portal.home))


def test_numbers_bear_a_minus_sign_and_names_keep_their_hyphen() -> None:
    rows = [("-1.5", "-30.2°", "(-45, 20)", "minervabot-v2", "found [150.0, -150.0]")]
    table = figures.table(["a", "b", "c", "d", "e"], rows).data
    assert "| −1.5 | −30.2° | (−45, 20) | minervabot-v2 | found [150.0, −150.0] |" in table
    boom = load_robot("rp-telescopic-boom")
    assert "lift = −35°, slide = 0.4 m" in texts_in(pose_picture(boom, boom.home))


def test_of_numbers_that_cannot_be_apart_some_are_left_out() -> None:
    ax = Figure(figsize=(4, 4)).subplots()
    ax.set(xlim=(-180, 180), ylim=(-180, 180), aspect="equal")
    turns = np.linspace(0, math.tau, 95, endpoint=False)
    places = 60 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    texts = figures.number_apart(ax, places, [0.0, 0.0])
    assert 15 < len(texts) < 95
    ways = (figures.number_apart, figures.number_points)
    few, plain = ([t.xyann for t in way(ax, places[::24], [0.0, 0.0])] for way in ways)
    assert np.allclose(few, plain)
    ax.figure.canvas.draw()
    boxes = [text.get_window_extent().shrunk(0.9, 0.7) for text in texts]
    assert not [1 for one, other in combinations(boxes, 2) if one.overlaps(other)]


NAMES = [
    "joint_1", "a_1", "_rest", "x^2", "50%", "q#1", "a{b", "a}b", "back\\slash", "$", "$x$",
    r"\$x\$", "upper arm", "theta1", "a&<b>", "~", "ends in \\", "Gelenk ä",
]  # fmt: skip


def texts_in(svg: bytes) -> set[str]:
    """Each text of a picture, as matplotlib notes it above the outlines of its letters."""
    ElementTree.fromstring(svg)
    return {html.unescape(note) for note in re.findall(r"<!-- (.*?) -->", svg.decode(), re.DOTALL)}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_drawn_letter_by_letter(name) -> None:
    figure = Figure()
    figure.text(0, 0, figures.as_text(name))
    picture = BytesIO()
    figure.savefig(picture, format="svg")
    assert name in texts_in(picture.getvalue())
    beside_a_formula = MathTextParser("path").parse(f"$q_{{1}}$ {figures.as_text(name)}").glyphs
    assert "".join(chr(glyph[2]) for glyph in beside_a_formula) == f"q1 {name}"


@pytest.mark.parametrize(
    ("name", "label"),
    [("q1", "$q_{1}$"), ("q12", "$q_{12}$"), ("d", "$d$"), ("θ2", "$θ_{2}$"), ("7", "7"),
     ("lift", "lift"), ("joint1", "joint1"), ("q_1", "q_1"), ("$5", r"\$5"), ("a\nb", r"a\nb")],
)  # fmt: skip
def test_a_letter_with_a_number_is_a_symbol_and_all_else_is_text(name, label) -> None:
    assert figures.symbol(name) == label


@pytest.mark.parametrize("seed", [None, *range(12)])
def test_every_arc_is_drawn_wherever_it_passes_the_window(ax, seed) -> None:
    """Each point of each arc, brought into the window, lies on one of the drawn lines."""
    region = find_region(load_robot("pr-gantry-arm") if seed is None else random_robot(seed))
    figures.draw_components(ax, region)
    scale = figures.joint_scales(region)
    drawn = np.concatenate([line.get_xydata() for line in ax.lines] or [np.zeros((0, 2))]) / scale
    rounds = [side is None for side in region.problem.ranges]
    for component in region.components:
        for arc in (arc for loop in component.loops for arc in loop):
            q = np.where(rounds, (arc.points + np.pi) % (2 * np.pi) - np.pi, arc.points)
            gap = np.abs(drawn[:, None] - q[::7]).max(axis=-1).min(axis=0)
            assert gap.max() < 1e-9


def test_spheres_are_drawn_where_forward_kinematics_puts_them(ax) -> None:
    robot = load_robot("two-joint-arm-with-walls")
    discs = figures.draw_spheres(ax, robot, robot.home)
    frames = robot.frames(robot.home)
    named = [p for p in robot.points if p.radius > 0]
    assert len(discs) == len(named) == 5
    for disc, point in zip(discs, named, strict=True):
        x, _, z = frames.position("base", point.name, "base")
        assert_allclose([*disc.center, disc.radius], [x, z, point.radius])
        assert disc.get_fill() == (point.frame == "base") or disc.get_facecolor()[3] == 0


def test_a_second_plot_has_a_figure_of_its_own() -> None:
    from matplotlib import pyplot

    region = find_region(load_robot("pp-portal"))
    one, two = region.plot(), region.plot()
    assert one.figure is not two.figure
    assert len(one.lines) == len(two.lines)
    pyplot.close("all")


def test_the_plot_of_an_empty_region_says_so(ax) -> None:
    floor = replace(MINERVA.boundary("B7"), name="the_$floor", offset=100.0)
    region = find_region(replace(MINERVA, boundaries=(floor,)))
    region.plot(ax)
    (text,) = (text.get_text() for text in ax.texts)
    assert text == "No configuration is feasible:\nno room is left by the_\\$floor"
    svg = pose_picture(MINERVA, MINERVA.home, region)
    assert "No configuration is feasible" in " ".join(texts_in(svg))
    told = find_region(MINERVA).plot(Figure().subplots()).texts
    assert not [text for text in told if "No configuration" in text.get_text()]


def test_a_slide_is_a_carriage_on_a_rail_and_no_link_leads_to_the_base(ax) -> None:
    """The gantry's rail lies at 1.2 m from -2 to 2 m; its arm hangs 0.8 m down from the cart."""
    artists = figures.draw_robot(ax, load_robot("pr-gantry-arm"), [0.9, 0.0], bodies=False)
    spine, turning, tool, rail, _, carriage = artists
    assert_allclose(spine.get_xydata(), [[0.9, 1.2], [0.9, 1.2], [0.9, 0.4]], atol=1e-12)
    assert_allclose(turning.get_xydata(), [[0.9, 1.2]])
    assert_allclose(tool.get_xydata(), [[0.9, 0.4]], atol=1e-12)
    assert_allclose(rail.get_xydata(), [[-2.0, 1.2], [2.0, 1.2]])
    assert_allclose(carriage.get_xydata(), [[0.9, 1.2]])


def test_a_number_at_the_middle_itself_has_a_place(ax) -> None:
    (number,) = figures.number_points(ax, [[3.0, 4.0]], [3.0, 4.0], labels=[7])
    assert number.get_text() == "7"
    assert np.isfinite(number.xyann).all()


def test_a_picture_of_an_arm_names_its_obstacles() -> None:
    robot = load_robot("two-links-on-a-table")
    ax = Figure().subplots()
    assert texts(figures.name_obstacles(ax, robot, figures.drawn_plane(robot))) == [
        body.name for body in robot.obstacles
    ]


@pytest.mark.parametrize("far", [1e4, 1e15, 1e100])
def test_a_pose_many_turns_away_is_drawn_with_few_ticks(far) -> None:
    axes = Figure().subplots()
    _pose_panel(axes, find_region(MINERVA), None, np.array([far, 0.0]))
    assert len(axes.get_xticks()) < 50


@pytest.mark.parametrize("closed", [False, True])
def test_path_is_drawn_in_order_with_an_arrow_a_leg(ax, closed) -> None:
    path = traverse(MINERVA, SIX[:5], closed=closed)
    tool = path.tool[:, [0, 2]]
    artists = figures.draw_path(ax, tool, list(path.stops))
    others = [a for a in artists if not hasattr(a, "get_xydata") or a.get_linestyle() == "None"]
    lines = [a for a in artists if hasattr(a, "get_xydata") and a.get_linestyle() != "None"]
    drawn = [lines[0].get_xydata()] + [line.get_xydata()[1:] for line in lines[1:]]
    assert_allclose(np.concatenate(drawn), tool)
    arrows = [a for a in others if isinstance(a, Annotation) and a.arrow_patch]
    legs = list(zip(path.stops[:-1], path.stops[1:], strict=True))
    assert len(arrows) == len(legs) == 5 if closed else 4
    for arrow, (start, end) in zip(arrows, legs, strict=True):
        middle = (start + end) // 2
        assert_allclose(arrow.xy, tool[middle + 1])  # the head, further on than the tail
        assert_allclose(arrow.xyann, tool[middle])
    assert texts(others) == ["1", "2", "3", "4", "5"]  # a closed path's last stop is its first
    marks = next(a for a in others if hasattr(a, "get_xydata"))
    assert_allclose(marks.get_xydata(), tool[path.stops[:5]])


def test_a_table_keeps_the_bar_of_an_absolute_value_in_its_cell() -> None:
    text = figures.table(["step", "holds"], [("so |c| ≤ d", "yes"), (-3, "no")]).data
    assert text.splitlines()[2:] == [r"| so \|c\| ≤ d | yes |", "| \N{MINUS SIGN}3 | no |"]


def test_single_legs_of_a_path_have_their_own_look(ax) -> None:
    path = traverse(MINERVA, SIX[:4])
    artists = figures.draw_path(
        ax, path.tool[:, [0, 2]], path.stops, legs={1: {"color": figures.COLLIDING, "ls": "--"}}
    )
    lines = [a for a in artists if hasattr(a, "get_xydata") and a.get_linestyle() != "None"]
    assert [line.get_linestyle() for line in lines] == ["-", "--", "-"]
    assert lines[1].get_color() == figures.COLLIDING
