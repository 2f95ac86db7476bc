"""What one types in Python: names, equality, one question asked of one configuration or of many."""

import ast
import inspect
import json
import pickle
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from numpy.testing import assert_allclose, assert_array_equal

import cspace
from cspace import (
    clearance,
    find_region,
    find_slices,
    is_feasible,
    keeps_clear,
    load_robot,
    margins,
    packaged_robots,
    sample,
    save_robot,
    violated,
    why,
)
from cspace.boundary.evaluator import evaluator
from cspace.export.outlines import find_outlines
from cspace.proofs.certificates.certify import bracket_scale, certify, certify_region
from cspace.proofs.certificates.statements import box
from cspace.region import Problem, solve
from engine_support.forms import LENS, LIMITS, RR, forms
from qbound.circle import circle_arc, circle_roots

MINERVA = load_robot("minervabot-v2")
REGION = find_region(MINERVA)
TWO = [name for name in packaged_robots() if name != "ur5"]
OWN = solve(
    Problem(forms(RR, {"10": 1.0, "01": 1.0, "00": -0.5}), ("lens",), ((-3.0, 3.0), None), LIMITS)
)
"""A region of a form of one's own: cos q1 + cos q2 > 0.5."""
FLOOR = clearance(MINERVA, "B7")
UR5 = load_robot("ur5")
WRONG = {
    "solve(None)": (lambda: solve(None), "problem: wanted a Problem"),
    "solve of a robot": (lambda: solve(MINERVA), "problem: wanted a Problem"),
    "base": (lambda: solve(OWN.problem, base=5), "base: 0 or 1 is wanted, found 5"),
    "held": (lambda: find_region(MINERVA, held=[0]), "held: wanted values by joint"),
    "values of slices": (lambda: find_slices(UR5, 2, ["a"]), "no array of real numbers"),
    "no path": (lambda: load_robot(None), "source: wanted a path"),
    "robot as path": (lambda: load_robot(MINERVA), "source: wanted a path"),
    "limits": (lambda: load_robot("ur5.urdf", limits=5), "limits: wanted ranges by joint"),
    "one limit": (lambda: load_robot("ur5.urdf", limits={"j": 5}), "limits of 'j': wanted two"),
    "chain": (lambda: load_robot("ur5.urdf", chain="tool0"), "chain: wanted a first and a last"),
    "excess": (lambda: load_robot("ur5.urdf", excess="2cm"), "excess: wanted a number of metres"),
    "SRDF": (lambda: load_robot("ur5.urdf", srdf=5), "srdf: wanted the path"),
    "saved": (lambda: save_robot("minervabot-v2", "x.toml"), "save_robot takes a Robot"),
    "saved where": (lambda: save_robot(MINERVA, None), "path: wanted the path"),
    "boundary": (lambda: clearance(MINERVA, 7), "boundary: wanted a boundary of the robot"),
    "boundary's name": (lambda: clearance(MINERVA, "B8"), "no boundary 'B8'; there are B1, "),
    "problem of None": (lambda: Problem(None, (), (), ()), "forms: wanted a stack of forms"),
    "one name": (lambda: Problem(OWN.problem.forms, "a", (), ()), "names: wanted a tuple"),
    "rows of unlike lengths": (lambda: is_feasible(MINERVA, [[0, 0], [1]]), "no array of real"),
    "clear of 5": (lambda: keeps_clear(5, [0, 0]), "keeps_clear takes a Robot"),
    "clear, compiled by a text": (
        lambda: keeps_clear(MINERVA, [0, 0], compiled="yes"),
        "compiled: wanted True or False",
    ),
    "clear by no thread": (lambda: keeps_clear(MINERVA, [0, 0], threads=0), "threads: 0; 1 or"),
    "a masked value": (
        lambda: keeps_clear(MINERVA, np.ma.masked_invalid([[0, np.nan]])),
        "a value is masked",
    ),
    "sample of texts": (lambda: sample(MINERVA, "a"), "n: wanted a whole number"),
    "sample of none": (lambda: sample(MINERVA, 0), "n: 0; 1 or more"),
    "seed": (lambda: sample(MINERVA, 5, seed="a"), "seed: wanted a whole number"),
    "predicate": (lambda: sample(MINERVA, 5, 5), "predicate: wanted a function"),
    "region's sample": (lambda: REGION.sample(1.5), "n: wanted a whole number"),
    "why of 5": (lambda: why(5, [0, 0], [0, 0]), "source: wanted a Robot"),
    "why's seed": (lambda: why(MINERVA, [0, 0], [0, 0], seed=-1), "seed: -1; 0 or more"),
    "deviation": (lambda: REGION.to_geojson("a"), "deviation: wanted a number above 0"),
    "axes": (lambda: REGION.plot(5), "ax: wanted the Axes"),
    "certified": (lambda: certify("minervabot-v2", {}), "subject: wanted a Robot, or the content"),
    "inset": (lambda: certify_region(MINERVA, None), "inset: wanted a number above 0"),
    "width": (lambda: bracket_scale(MINERVA, width=0), "width: 0 is no finite number above 0"),
    "narrow": (lambda: bracket_scale(MINERVA, width=1e-14), "width: 1e-14; 4e-12 or more"),
}
BAD = [float("nan"), float("inf"), -float("inf"), 1j]


def configurations(robot, n=500):
    """Draw configurations, some of them beyond limits."""
    low, high = np.array([joint.limits or (-4.0, 4.0) for joint in robot.joints]).T
    room = 0.1 * (high - low)
    return np.random.default_rng(5).uniform(low - room, high + room, (n, len(low)))


# --- arguments of other types ---------------------------------------------------------------------


@pytest.mark.parametrize("name", WRONG)
def test_an_argument_of_another_type_is_named(name) -> None:
    """Most of them ended in an AttributeError from far inside; a form plus a text was a form."""
    call, said = WRONG[name]
    with pytest.raises((TypeError, ValueError, ZeroDivisionError), match=re.escape(said)):
        call()


def test_what_a_notebook_shows_of_an_answer_is_a_line() -> None:
    """They showed arrays and whole certificates, thousands of letters."""
    far = np.where(np.arange(6) == 2, 4.7, UR5.home)
    for found, said in (
        (why(MINERVA, [0, 0], [0.2, -0.5]), "<Why: connected by a path of 2 corners>"),
        (why(MINERVA, [0, 0], [1.6, 0.0]), "<Why: infeasible: goal violates B7>"),
        (why(UR5, UR5.home, far), "<Why: separated: elbow_joint cannot pass>"),
        (certify(MINERVA, box(["0", "0"], ["1", "1"])), "<Certificate: proved, 5 cells>"),
        (certify(MINERVA, box(["90", "0"], ["90", "0"])), "<Certificate: refuted, B7 is violated>"),
        (
            cspace.fibres(UR5, 2, UR5.home),
            "<Fibres of elbow_joint: 3 intervals of 1 configuration>",
        ),
        (sample(MINERVA, 1000), "<Sample: 1000 configurations, 0.6.* [+]- 0.015 of them feasible>"),
    ):
        assert re.fullmatch(said, repr(found))


def test_what_is_natural_is_taken() -> None:
    assert_array_equal(FLOOR.coefficients, clearance(MINERVA, MINERVA.boundary("B7")).coefficients)
    assert certify(MINERVA, box(["0", "0"], ["1", "1"])).verdict == "proved"
    assert_array_equal(sample(MINERVA, 5).q, sample(MINERVA, 5, seed=0).q)


# --- names ----------------------------------------------------------------------------------------


def test_the_front_door_shows_what_a_user_needs_and_nothing_else() -> None:
    assert sorted(dir(cspace)) == sorted([*cspace.__all__, "__version__"])
    assert len(cspace.__all__) <= 22
    assert {"keeps_clear", "sample", "why", "fibres", "is_feasible"} <= {*cspace.__all__}
    for moved in ("components", "pair_vector", "circle_arc", "circle_roots"):
        with pytest.raises(AttributeError):
            getattr(cspace, moved)


def test_the_index_of_the_api_page_has_every_name_of_the_front_door() -> None:
    page = (Path(__file__).parents[2] / "book" / "api.md").read_text("utf-8")
    index = page.split("## Index by name")[1].split("\n## ")[0]
    assert re.findall(r"^\| `(\w+)` \|", index, re.MULTILINE) == cspace.__all__
    for name in cspace.__all__:
        target = getattr(cspace, name)
        assert f"`{target.__module__}.{name}`" in index


# --- robots ---------------------------------------------------------------------------------------


def test_a_configuration_just_beyond_an_arc_is_in_no_component():
    region, seen = find_region(load_robot("minervabot-v2")), 0
    for component in region.components:
        for arc in (arc for loop in component.loops for arc in loop if arc.form is not None):
            slope = arc.form.gradient(arc.at(0.5))
            beyond = arc.at(0.5) - 1e-9 * slope / np.linalg.norm(slope)
            if not region.contains(beyond):
                assert region.components_of(beyond) == ()
                assert region.component_of(beyond) is None
                seen += 1
    assert seen > 10


@pytest.mark.parametrize("name", packaged_robots())
def test_robots_are_equal_by_content(name) -> None:
    one, other = load_robot(name), load_robot(name)
    assert one == other
    assert hash(one) == hash(other)
    assert one == replace(one, source=None) == pickle.loads(pickle.dumps(one))
    assert one != replace(one, name="another")
    assert one != replace(one, home=one.home + 0.25)
    assert one != name


def test_one_number_anywhere_makes_another_robot() -> None:
    robot = load_robot("two-links-on-a-table")
    body = robot.obstacles[0]
    shape = replace(body.shape, at=body.shape.at + 0.1)
    moved = (replace(body, shape=shape), *robot.obstacles[1:])
    joint = replace(robot.joints[0], origin=robot.joints[0].origin + 0.1)
    others = [
        replace(robot, obstacles=moved),
        replace(robot, joints=(joint, *robot.joints[1:])),
        replace(robot, clearance=0.001),
    ]
    assert len({robot, load_robot("two-links-on-a-table"), *others}) == 4


def test_a_hash_of_another_process_is_not_taken_over() -> None:
    hash(MINERVA)
    assert not {"_hash", "_content"} & set(vars(pickle.loads(pickle.dumps(MINERVA))))


def test_a_robot_of_bodies_says_so() -> None:
    table = load_robot("two-links-on-a-table")
    assert repr(table).endswith("elbow (revolute); 8 pairs of bodies>")
    assert repr(load_robot("minervabot-v2-bodies")).endswith("; 1 boundary and 3 pairs of bodies>")


@pytest.mark.parametrize("name", TWO)
def test_inverse_kinematics_lead_back(name) -> None:
    robot = load_robot(name)
    for q in configurations(robot, 20):
        place = robot.forward_kinematics(q)
        found = robot.inverse_kinematics(place)
        assert_allclose(robot.forward_kinematics(found), np.tile(place, (len(found), 1)), atol=1e-9)
        inside = not any(
            f"{j.name}." in bound for j in robot.joints for bound, _ in violated(robot, q)
        )
        turns = [joint.limits is None for joint in robot.joints]
        off = np.where(turns, np.sin((found - q) / 2), found - q)
        assert not inside or np.abs(off).max(axis=-1).min() < 1e-6


def test_forward_kinematics_are_the_frames() -> None:
    robot = load_robot("ur5")
    q = np.random.default_rng(2).uniform(-3, 3, (4, 5, 6))
    places = robot.forward_kinematics(q)
    assert places.shape == (4, 5, 3)
    frames = robot.frames(q[1, 2])
    assert_allclose(places[1, 2], frames.position(robot.base, robot.tool, robot.base))
    assert_array_equal(robot.forward_kinematics(q, robot.base), np.zeros((4, 5, 3)))
    with pytest.raises(ValueError, match="no point or frame 'nowhere'"):
        robot.forward_kinematics(q, "nowhere")


def test_kinematics_refuse_what_is_no_place() -> None:
    arm = load_robot("two-joint-arm-with-walls")
    assert arm.inverse_kinematics([0.5, 0.1, 0.2]).shape == (0, 2)  # beside the tool's plane
    with pytest.raises(ValueError, match="three finite coordinates"):
        arm.inverse_kinematics([0.5, 0.2])
    with pytest.raises(ValueError, match="not two"):
        load_robot("ur5").inverse_kinematics([0.5, 0.0, 0.2])
    for bad in BAD:
        with pytest.raises(ValueError, match=r"finite|real"):
            arm.inverse_kinematics([0.5, 0.0, bad])
        with pytest.raises(ValueError, match=r"finite|no array of numbers"):
            arm.forward_kinematics([0.5, bad])


# --- one configuration or many --------------------------------------------------------------------


@pytest.mark.parametrize("name", packaged_robots())
def test_margins_of_many_are_those_of_each(name) -> None:
    robot = load_robot(name)
    q = configurations(robot, 12).reshape(3, 4, -1)
    found = margins(robot, q)
    names = [boundary for boundary, _ in margins(robot, q[0, 0])]
    assert found.shape == (3, 4, len(names))
    assert names == list(evaluator(robot).names)
    each = [[[margin for _, margin in margins(robot, x)] for x in row] for row in q]
    assert_allclose(found, each, atol=1e-9)
    assert_array_equal(is_feasible(robot, q), (found >= 0).all(axis=-1))
    assert_array_equal(is_feasible(robot, q), [[not violated(robot, x) for x in row] for row in q])


def test_feasible_counts_limits_and_keeping_clear_does_not() -> None:
    robot = load_robot("ur5")
    q = np.array([7.0, -1.57, 1.57, -1.57, -1.57, 0.0])
    assert keeps_clear(robot, q)
    assert not is_feasible(robot, q)
    assert "limits" in inspect.getdoc(keeps_clear).splitlines()[0]


@pytest.mark.parametrize("name", TWO)
def test_components_of_many_are_those_of_each(name) -> None:
    robot = load_robot(name)
    region = find_region(robot)
    corners = [vertex.q for component in region.components for vertex in component.vertices]
    q = np.concatenate([configurations(robot), *(np.array(corners).reshape(-1, 2),)])
    each = [region.component_of(x) for x in q]
    assert_array_equal(region.component_of(q), [-1 if k is None else k for k in each])
    assert len({*each}) > 1
    assert region.component_of(q[:6].reshape(3, 2, 2)).shape == (3, 2)
    assert region.component_of(np.empty((0, 2))).shape == (0,)


@pytest.mark.parametrize("bad", BAD)
def test_what_is_no_real_number_is_refused_everywhere(bad) -> None:
    q = [0.2, bad]
    questions = [
        REGION.margins,
        REGION.contains,
        REGION.component_of,
        REGION.components_of,
        REGION.nearest,
        OWN.contains,
        MINERVA.frames,
        lambda q: margins(MINERVA, q),
        lambda q: is_feasible(MINERVA, q),
        lambda q: keeps_clear(MINERVA, q),
        lambda q: violated(MINERVA, q),
    ]
    for ask in questions:
        with pytest.raises(ValueError, match=r"NaN|finite|real|numbers"):
            ask(q)
    for solve_one in (circle_roots, circle_arc):
        with pytest.raises(ValueError, match=r"finite|real"):
            solve_one(bad, 1.0, 0.5)
    for ask in (REGION.contains, REGION.component_of, lambda q: margins(MINERVA, q)):
        with pytest.raises(ValueError, match=r"NaN|finite|real|numbers"):
            ask(np.array([q] * 300))


# --- drawing from a region, and what is near ------------------------------------------------------


@pytest.mark.parametrize("region", [REGION, OWN, find_region(load_robot("pr-gantry-arm"))])
def test_a_sample_is_even_over_the_area(region) -> None:
    q = region.sample(4000, seed=7)
    assert region.contains(q).all()
    assert_array_equal(q, region.sample(4000, np.random.default_rng(7)))
    part = np.array([component.area for component in region.components]) / region.area
    drawn = np.bincount(region.component_of(q), minlength=len(part)) / len(q)
    assert_allclose(drawn, part, atol=4 * np.sqrt(0.25 / len(q)))
    # a uniform density: the mean of any function is its integral over the area
    largest = region.components[int(part.argmax())]
    if largest.centroid is not None:
        own = q[region.component_of(q) == part.argmax()]
        turns = [ends is None for ends in region.problem.ranges]
        off = own - largest.centroid
        off = np.where(turns, (off + np.pi) % (2 * np.pi) - np.pi, off)
        assert (np.abs(off.mean(axis=0)) < 5 * own.std(axis=0) / np.sqrt(len(own))).all()


def test_nothing_is_drawn_from_an_empty_region() -> None:
    floor = replace(MINERVA.boundary("B7"), offset=100.0)
    with pytest.raises(ValueError, match="empty"):
        find_region(replace(MINERVA, boundaries=(floor,))).sample(3)
    assert REGION.sample(0, 1).shape == (0, 2)


def test_the_nearest_boundary_is_asked_of_the_region() -> None:
    point = REGION.nearest([0.2, -0.5])
    assert point.boundary == "B7"
    assert_allclose(np.linalg.norm(point.q - [0.2, -0.5]), point.distance)
    assert REGION.nearest([0.2, -0.5], component=1).component == 1


def test_sampling_takes_what_keeps_clear_unless_told_otherwise() -> None:
    drawn = sample(MINERVA, 50, seed=3)
    assert_array_equal(drawn.free, keeps_clear(MINERVA, drawn.q))


# --- arcs, slices, forms --------------------------------------------------------------------------


def test_an_arc_is_asked_at_a_number() -> None:
    arc = REGION.home_component.loops[0][0]
    assert arc.at(0.5).shape == (2,)
    assert_allclose([arc.at(0), arc.at(1)], [arc.start, arc.end])
    assert_array_equal(arc.at([[0.1, 0.2, 0.3]])[0, 1], arc.at(0.2))
    for bad in (float("nan"), 1j):
        with pytest.raises(ValueError, match=r"NaN|real"):
            arc.at(bad)


def test_slices_are_gone_through() -> None:
    slices = find_slices(load_robot("ur5"), "elbow_joint", [1.5, 1.6], {0: 0.0, 4: 0.0, 5: 0.0})
    assert len(slices) == 2
    assert [*slices] == [*slices.regions]


# --- pictures and exports -------------------------------------------------------------------------


def test_a_picture_in_radians_holds_data_of_ones_own() -> None:
    axes = REGION.plot(Figure().subplots(), unit="rad", facecolor="red", label="safe", alpha=0.5)
    assert axes.get_xlabel().endswith("/ rad")
    assert axes.get_xlim()[1] < 4
    assert {patch.get_facecolor() for patch in axes.patches} == {to_rgba("red", 0.5)}
    assert axes.get_legend_handles_labels()[1] == ["safe"]
    degrees = REGION.plot(Figure().subplots())
    assert degrees.get_xlabel().endswith("/ °")
    for one, other in zip(axes.patches, degrees.patches, strict=True):
        assert_allclose(np.degrees(one.get_path().vertices), other.get_path().vertices)
    with pytest.raises(ValueError, match="no unit 'grad'"):
        REGION.plot(Figure().subplots(), unit="grad")


def test_one_component_is_drawn_and_handed_on_alone() -> None:
    every, alone = (REGION.plot(Figure().subplots(), component=k) for k in (None, 1))
    assert len(alone.patches) * len(REGION.components) == len(every.patches)
    assert REGION.to_shapely(component=1).area == pytest.approx(REGION.components[1].area, abs=2e-3)


def test_a_region_of_own_forms_is_drawn_and_handed_on() -> None:
    assert repr(OWN) == f"<Region: 1 component, area {OWN.area:.6g} rad^2>"
    assert OWN.area == pytest.approx(LENS, rel=1e-12)
    axes = OWN.plot(Figure().subplots())
    assert axes.get_xlabel() == "$q_{1}$ / °"
    assert axes.patches
    assert "<svg" in OWN._repr_svg_()
    assert OWN.to_shapely().area == pytest.approx(OWN.area, abs=1e-2)
    assert OWN.to_geojson()["features"][0]["properties"]["joints"] == ["q1", "q2"]
    assert len(find_outlines(OWN).pieces) == 1


@pytest.mark.parametrize("what", ["to_dict", "explore"])
def test_what_takes_a_robot_says_so_by_name(what) -> None:
    with pytest.raises(ValueError, match=rf"{what}: this region is of forms, not of a robot; plot"):
        getattr(OWN, what)()


# --- why ------------------------------------------------------------------------------------------


def test_why_takes_a_robot_as_it_is(tmp_path) -> None:
    ends = [0.0, 0.0], [0.2, -0.5]
    named = why("minervabot-v2", *ends)
    loaded = why(MINERVA, *ends)
    assert loaded.robot is MINERVA
    assert loaded.answer == named.answer == "connected"
    assert loaded.certificate.text == named.certificate.text


def test_why_certifies_a_changed_robot_as_it_would_be_saved(tmp_path) -> None:
    changed = replace(MINERVA, boundaries=(replace(MINERVA.boundary("B7"), offset=12.0),))
    found = why(changed, [0.0, 0.0], [0.2, -0.5])
    save_robot(changed, tmp_path / "arm.toml")
    assert found.answer == why(tmp_path / "arm.toml", [0.0, 0.0], [0.2, -0.5]).answer == "connected"
    assert "offset = 12.0" in found.certificate.text.replace("\\n", "\n")


# --- importing the package stays light ------------------------------------------------------------


HEAVY = ["sympy", "matplotlib", "jsonschema", "scipy", "shapely", "IPython", "pandas", "flint"]
HEAVY += ["tomlkit"]
SHOW = "import sys, json; print(json.dumps(sorted({m.split('.')[0] for m in sys.modules})))"


def loaded_by(code: str) -> set[str]:
    """Top-level modules of a fresh interpreter after some code."""
    run = [sys.executable, "-c", f"{code}\n{SHOW}"]
    return set(json.loads(subprocess.run(run, capture_output=True, check=True).stdout))


def test_import_loads_no_heavy_module() -> None:
    assert not loaded_by("import cspace") & {"numpy", "msgspec", *HEAVY}


def test_every_module_of_the_package_imports_without_the_heavy_ones() -> None:
    code = (
        "import importlib, pkgutil, cspace\nfrom cspace import *\n"
        "for m in pkgutil.iter_modules(cspace.__path__):\n"
        "    importlib.import_module('cspace.' + m.name)"
    )
    assert not loaded_by(code) & set(HEAVY)


def test_numbers_never_call_sympy() -> None:
    """From the file to the vertices and a sample: the file is checked, no symbol is made."""
    modules = loaded_by(
        "import cspace, numpy\n"
        "from cspace import sampling\nfrom qbound import window_region\n"
        "from cspace.paths import traversal\n"
        "robot = cspace.load_robot('minervabot-v2')\n"
        "q = window_region(robot).polygon\n"
        "traversal.traverse(robot, q)\n"
        "sampling.sample(robot, 10, sampling.keeps_clear, seed=1)"
    )
    assert "msgspec" in modules
    assert not modules & {"sympy", "matplotlib", "jsonschema", "tomlkit"}


def test_the_front_door_opens_on_what_type_checkers_see() -> None:
    tree = ast.parse(Path(cspace.__file__).read_text(encoding="utf-8"))
    [seen] = [
        node
        for node in tree.body
        if isinstance(node, ast.If)
        and "TYPE" in ast.unparse(node.test)
        and not isinstance(node.test, ast.UnaryOp)
    ]
    imports = [node for node in seen.body if isinstance(node, ast.ImportFrom)]
    told = {node.module: tuple(name.name for name in node.names) for node in imports}
    places = {f"cspace.{place}": names for place, names in cspace._PLACES.items()}
    assert places == told | {"cspace.version": ("__version__",)}
    assert sorted(name for names in told.values() for name in names) == cspace.__all__
    assert {*dir(cspace)} == {*cspace.__all__, "__version__"}
    assert cspace.units.__name__ == "cspace.units"
    with pytest.raises(AttributeError, match="'cspace' has no attribute 'find_regions'"):
        cspace.find_regions  # noqa: B018


def test_version_is_that_of_the_metadata() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))
    assert cspace.__version__ == project["project"]["version"]
