"""Surfaces of three joints: known volumes, vertices on their functions, both sides, files, page."""

import json
import math
import re
from base64 import b64decode
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from qbound import load_robot
from qbound.arms.surface_forms import SurfaceForms, axis_of
from qbound.arms.surfaces import COLOURS, OTHERS, colour_of, find_surface, glb_bytes, ply_bytes
from qbound.boundary.balls import Balls
from qbound.cli import main
from qbound.explorer.surface_page import surface_data, surface_page
from qbound.figures.surfaces import surface_picture
from qbound.model.robot import HalfSpace, Pair, Revolute, Robot
from qbound.model.robotfile import save_robot
from support.portals import AXES, NAMES, dice, point, portal


def round_hole(at=(0.1, 0.05, -0.02), radius=0.75) -> Robot:
    points = (point("hand", "3"), point("ball", "0", at, radius))
    return portal(points, (Pair("apart", ("hand", "ball")),))


def arm(limits=None) -> Robot:
    """Three joints in space, balls on the links, a post, and a floor."""
    mounts = Rotation.from_euler("xyz", [[0, 0, 0], [0.4, 0, 0], [0, 0.3, 0.2]]).as_matrix()
    joints = tuple(
        Revolute(f"q{k}", str(k), str(k + 1), np.array([0.5 * (k > 0), 0, 0.1]), mounts[k],
                 AXES[2 - (k == 1)], limits)
        for k in range(3)
    )  # fmt: skip
    points = (
        point("post/1", "0", (0.6, 0.5, 0.1), 0.15), point("base/1", "0", (0, 0, 0), 0.1),
        point("fore/1", "2", (0.3, 0, 0), 0.1), point("hand/1", "3", (0.2, 0, 0), 0.1),
        point("hand/2", "3", (0.35, 0, 0), 0.1),
    )  # fmt: skip
    pairs = [(a, b) for a in ("post/1", "base/1") for b in ("fore/1", "hand/1", "hand/2")]
    bounds = tuple(Pair(", ".join(pair), pair) for pair in pairs)
    floor = HalfSpace("floor, hand/2", "hand/2", AXES[2], -0.15)
    return Robot("arm", joints, points, (*bounds, floor), np.zeros(3), "hand/2", "m", "rad")


def least_margins(surface, places) -> np.ndarray:
    """Judge places by forward kinematics and distances, which the surface does not use."""
    free = [axis.joint for axis in surface.axes]
    q = np.tile(surface.robot.home, (len(places), 1))
    q[:, list(surface.held)] = list(surface.held.values())
    q[:, free] = places
    return Balls.of(surface.robot).margins(q).min(axis=1)


# --- the same on every processor ------------------------------------------------------------------


def one_turn_of_a_ur5() -> tuple[Robot, list[str]]:
    """Shoulder, elbow and wrist, on whose surface many functions are equal, as in chapter 20."""
    ur5, turn = load_robot("ur5"), (-np.pi, np.pi)
    limits = {1: turn, 2: (-3.0, 3.0), 3: turn}
    joints = tuple(
        replace(joint, limits=limits.get(j, joint.limits)) for j, joint in enumerate(ur5.joints)
    )
    return replace(ur5, joints=joints), [ur5.joints[j].name for j in limits]


@pytest.mark.parametrize("seed", range(3))
def test_another_processors_rounding_changes_no_triangle(monkeypatch, seed) -> None:
    """Other kernels add a sum's terms in another order: the values move by some last bits."""
    robot, names = one_turn_of_a_ur5()
    here = find_surface(robot, names, resolution=20, caps=True)
    random, rounded = np.random.default_rng(seed), SurfaceForms._monomials

    def monomials(forms: SurfaceForms, q: np.ndarray) -> np.ndarray:
        exact = rounded(forms, q)
        return exact * (1 + 2.0**-52 * random.integers(-1, 2, exact.shape))

    monkeypatch.setattr(SurfaceForms, "_monomials", monomials)
    there = find_surface(robot, names, resolution=20, caps=True)
    assert there.triangles.shape == here.triangles.shape
    assert (there.triangles == here.triangles).all()
    assert (there.active == here.active).all()
    assert_allclose(there.vertices, here.vertices, atol=1e-9)
    assert_allclose(there.volume, here.volume, rtol=1e-9)


# --- known shapes --------------------------------------------------------------------------------


def test_a_ball_has_its_volume_and_every_vertex_its_radius() -> None:
    """The error is that of chords, of second order: a quarter at twice the steps."""
    robot, errors = round_hole(), []
    for resolution in (10, 20):
        surface = find_surface(robot, NAMES, resolution=resolution, caps=True)
        errors.append(surface.volume - (8 - 4 / 3 * math.pi * 0.75**3))
        own = np.unique(surface.triangles[surface.pair == surface.pairs.index("apart")])
        at = robot.point("ball").at
        assert_allclose(np.linalg.norm(surface.vertices[own] - at, axis=1), 0.75, atol=1e-12)
        assert surface.exact.all()
    assert 0 < 3 * errors[1] < errors[0] < 5 * errors[1] < 0.1


def test_a_turned_cube_is_exact_with_its_edges_and_corners() -> None:
    surface = find_surface(dice(), NAMES, resolution=9)
    closed = find_surface(dice(), NAMES, resolution=9, caps=True)
    assert closed.volume == pytest.approx(1, abs=1e-12)
    assert surface.areas.sum() == pytest.approx(6 / 4, abs=1e-12)  # in parts of ranges of 2
    assert len(surface.pairs) == 6
    assert surface.exact.all()
    corners = np.array([r.normal for r in surface.robot.boundaries[::2]]).T @ (
        np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1)
    )
    for corner in corners.T:
        assert np.linalg.norm(surface.vertices - corner, axis=1).min() < 1e-12


def test_a_strip_narrower_than_a_step_is_kept_between_its_neighbours() -> None:
    """An edge cut off along its whole length: the three planes have no point in common."""
    turned = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    one, other = turned[:, 0], turned[:, 1]
    planes = {"one": (-one, -0.3), "other": (-other, -0.3), "strip": (-(one + other), -0.58)}
    robot = portal(
        (point("hand", "3"),),
        tuple(HalfSpace(name, "hand", *plane) for name, plane in planes.items()),
    )
    surface = find_surface(robot, NAMES, resolution=8)
    assert surface.exact.all()
    assert set(surface.pairs) == {"one", "other", "strip"}
    strip = surface.triangles[surface.pair == surface.pairs.index("strip")]
    assert_allclose(surface.vertices[strip] @ (one + other), 0.58, atol=1e-12)
    assert least_margins(surface, surface.vertices).min() > -1e-12


def test_caps_close_a_box() -> None:
    far = (point("hand", "3"), point("ball", "0", (2, 0, 0), 0.9))
    box = find_surface(
        portal(far, (Pair("apart", ("hand", "ball")),)), NAMES, resolution=5, caps=True
    )
    assert box.volume == pytest.approx(8, abs=1e-12)
    assert len(box.pairs) == 6
    near = (point("hand", "3"), point("ball", "0", (1, 0, 0), 0.5))
    surface = find_surface(
        portal(near, (Pair("apart", ("hand", "ball")),)), NAMES, resolution=16, caps=True
    )
    assert surface.volume == pytest.approx(8 - 2 / 3 * math.pi * 0.5**3, abs=0.02)
    assert set(surface.pairs) == {"apart", *(f"q{k}.{end}" for k in range(3) for end in
                                             ("lower", "upper"))}  # fmt: skip


# --- arms ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def surface():
    return find_surface(arm(), NAMES, resolution=24)


def test_vertices_are_on_the_boundary_by_another_evaluator(surface) -> None:
    assert surface.exact.mean() > 0.999
    assert_allclose(least_margins(surface, surface.vertices[surface.exact]), 0, atol=1e-11)
    assert len(surface.pairs) >= 4


def test_triangles_lie_on_the_boundary_that_they_name(surface) -> None:
    q = surface.vertices[surface.triangles]
    names = [boundary.name for boundary in surface.robot.used]
    column = np.array([names.index(name) for name in surface.boundaries])[surface.active]
    values = Balls.of(surface.robot).margins(q.reshape(-1, 3)).reshape(*q.shape[:2], -1)
    own = np.take_along_axis(values, column[:, None, None], axis=2)[..., 0]
    assert (np.abs(own[surface.exact[surface.triangles].all(axis=1)]) < 1e-11).mean() > 0.998


def test_one_side_is_feasible_and_the_other_is_not(surface) -> None:
    a, b, c = np.moveaxis(surface.vertices[surface.triangles], 1, 0)
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    large = size > np.median(size) / 4
    middle, way = ((a + b + c) / 3)[large], normal[large] / size[large, None] * 0.05
    assert (least_margins(surface, middle + way) < 0).mean() > 0.99
    assert (least_margins(surface, middle - way) > 0).mean() > 0.97  # the rest: thin places


def test_edges_are_sharp(surface) -> None:
    """Where triangles of two boundaries meet, both functions vanish."""
    sides = np.stack([surface.triangles, np.roll(surface.triangles, -1, axis=1)], -1)
    sides = np.sort(sides.reshape(-1, 2), axis=1)
    labels = np.repeat(surface.active, 3)
    order = np.lexsort(sides.T)
    same = (sides[order][1:] == sides[order][:-1]).all(axis=1)
    two = same & (labels[order][1:] != labels[order][:-1])
    ends = sides[order][1:][two]
    assert len(ends) > 50
    names = [boundary.name for boundary in surface.robot.used]
    one, other = (
        np.array([names.index(surface.boundaries[k]) for k in part])
        for part in (labels[order][1:][two], labels[order][:-1][two])
    )
    values = np.abs(Balls.of(surface.robot).margins(surface.vertices[ends.ravel()]))
    values = values.reshape(*ends.shape, -1)
    rows = np.arange(len(ends))
    worst = np.maximum(values[rows, :, one], values[rows, :, other]).max(axis=1)
    assert (worst < 1e-11).mean() > 0.98


def test_both_sides_of_a_seam_are_the_same(surface) -> None:
    for k in range(3):
        others = [j for j in range(3) if j != k]
        low, high = (
            surface.vertices[surface.vertices[:, k] == end][:, others]
            for end in (-math.pi, math.pi)
        )
        apart = np.linalg.norm(low[:, None] - high[None], axis=2)
        for nearest in (apart.min(axis=0), apart.min(axis=1)):
            assert (nearest < 1e-9).mean() > 0.9
            assert nearest.max() < math.tau / surface.resolution


def test_limits_of_a_turn_or_more_are_one_turn_and_less_is_less() -> None:
    wide = find_surface(arm((-7.0, 7.0)), NAMES, resolution=12)
    assert [axis.ends for axis in wide.axes] == [(-math.pi, math.pi)] * 3
    assert axis_of(arm((1.0, 8.0)), 0).ends == (1.0, 1.0 + math.tau)
    narrow = find_surface(arm((-1.0, 2.0)), NAMES, resolution=12)
    assert narrow.vertices.min() >= -1
    assert narrow.vertices.max() <= 2
    assert narrow.volume is None
    solid = find_surface(arm((-1.0, 2.0)), NAMES, resolution=16, caps=True)
    rng = np.random.default_rng(0)
    free = (least_margins(solid, rng.uniform(-1, 2, (20_000, 3))) > 0).mean()
    assert solid.volume == pytest.approx(27 * free, rel=0.03)


def test_held_joints_are_at_home_unless_they_are_given() -> None:
    robot = load_robot("pr-gantry-arm")
    with pytest.raises(ValueError, match="three different joints"):
        find_surface(robot, ["cart", "arm"])
    robot = arm()
    more = replace(robot.joints[2], name="q3", parent="3", frame="4")
    robot = replace(robot, joints=(*robot.joints, more), home=np.array([0.1, 0.2, 0.3, 0.4]))
    assert find_surface(robot, [0, 1, 3], resolution=6).held == {2: 0.3}
    assert find_surface(robot, ["q3", "q1", "q0"], {"q2": 1.0}, resolution=6).held == {2: 1.0}


@pytest.mark.parametrize(
    ("joints", "held", "options", "text"),
    [
        (["q0", "q1"], {}, {}, "three different joints"),
        (["q0", "q1", "q1"], {}, {}, "three different joints"),
        (["q0", "q1", "elbow"], {}, {}, "no joint 'elbow'"),
        (NAMES, {"q1": 0.0}, {}, "q1: an axis of the surface is not held"),
        (NAMES, {}, {"resolution": 3}, "from 4 to 256"),
        (NAMES, {}, {"resolution": 1000}, "from 4 to 256"),
        (["q0", "q1", "q3"], {"q2": math.nan}, {}, "not finite|NaN|finite"),
        (["q0", "q1", "q3"], {"q2": 5.0}, {}, "q2: held at 5, beyond its limits"),
    ],
)
def test_what_is_no_surface_is_refused(joints, held, options, text) -> None:
    robot = arm((-1.0, 2.0))
    more = replace(robot.joints[2], name="q3", parent="3", frame="4")
    robot = replace(robot, joints=(*robot.joints, more), home=np.zeros(4))
    with pytest.raises(ValueError, match=text):
        find_surface(robot, joints, held, **options)


def test_where_nothing_ends_there_is_no_triangle() -> None:
    free = find_surface(round_hole(at=(9, 0, 0)), NAMES, resolution=6)
    assert (len(free.triangles), free.feasible_part, free.pairs) == (0, 1.0, ())
    none = find_surface(round_hole(radius=5), NAMES, resolution=6)
    assert (len(none.triangles), none.feasible_part) == (0, 0.0)
    for write in (ply_bytes, glb_bytes, surface_page):
        with pytest.raises(ValueError, match="there is no surface to"):
            write(free)


# --- files, picture, page, command ----------------------------------------------------------------


def test_meshes_are_what_another_library_reads(surface) -> None:
    read = trimesh.load(BytesIO(ply_bytes(surface)), file_type="ply", process=False)
    assert_allclose(read.vertices, surface.vertices, atol=1e-6)
    assert np.array_equal(read.faces, surface.triangles)
    assert set(map(tuple, read.visual.face_colors)) == {
        (*bytes.fromhex(colour_of(k)[1:]), 255) for k in range(len(surface.pairs))
    }
    scene = trimesh.load(BytesIO(glb_bytes(surface)), file_type="glb")
    assert set(scene.geometry) == set(surface.pairs)
    sizes = [len(scene.geometry[name].faces) for name in surface.pairs]
    assert sizes == np.bincount(surface.pair).tolist()


def test_pairs_of_links_share_a_colour_and_the_smallest_are_others(surface) -> None:
    assert "post, hand" in surface.pairs
    assert "floor, hand" in surface.pairs
    areas = np.bincount(surface.pair, surface.areas)
    assert (np.diff(areas) <= 0).all()
    assert [colour_of(k) for k in (0, len(COLOURS) - 1, len(COLOURS))] == [
        COLOURS[0], COLOURS[-1], OTHERS,
    ]  # fmt: skip


def test_the_picture_is_the_same_twice() -> None:
    small = find_surface(dice(), NAMES, resolution=5)
    one, other = (surface_picture(small, "png") for _ in range(2))
    assert one == other
    assert one.startswith(b"\x89PNG")


def test_the_page_has_the_surface_and_nothing_from_outside(surface) -> None:
    hostile = replace(surface, robot=replace(surface.robot, name="</script><b>&\u202e"))
    page = surface_page(hostile)
    assert "<b>" not in page
    assert "\u202e" not in page
    assert not re.search(r"(?:src|href)=|https?://", page)
    assert page.count("<script>") == 1
    data = json.loads(re.search(r'id="surface-data">(.*?)</script>', page)[1])
    assert data == surface_data(hostile)
    places = np.frombuffer(b64decode(data["places"]), "<u2").reshape(-1, 3)
    assert_allclose(places / 65535 * math.tau - math.pi, surface.vertices, atol=math.tau / 2**16)
    triangles = np.frombuffer(b64decode(data["triangles"]), "<u4").reshape(-1, 3)
    start, end = data["pairs"][1]["triangles"]
    assert np.array_equal(triangles[start:end], surface.triangles[surface.pair == 1])
    assert data["axes"][0] == {"name": "q0", "unit": "°", "ends": [-180.0, 180.0]}
    script = re.search(r"<script>(.*?)</script>", page, re.S)[1]
    assert len(script) < 20_000


def test_the_command(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    save_robot(arm(), "arm.toml")
    line = ["surface", "arm.toml", "--joints", *NAMES, "--resolution", "6"]
    for name in ("a.html", "a.svg", "a.ply", "a.glb"):
        assert main([*line, "-o", name]) == 0
        assert (tmp_path / name).stat().st_size > 1000
        out, err = capsys.readouterr()
        assert (err, "triangles; " in out, "%  post, hand" in out) == ("", True, True)
    for bad in (["-o", "a.obj"], ["--slice", "q1=10deg"], ["--resolution", "2"]):
        assert main([*line, *bad]) == 2
    assert main(["surface", "arm.toml", "--joints", "q0", "q1", "no"]) == 2
    assert "no joint 'no'" in capsys.readouterr().err.splitlines()[-1]
    save_robot(round_hole(radius=5), "full.toml")
    assert main(["surface", "full.toml", "--joints", *NAMES, "--resolution", "6"]) == 1
    assert "no configuration of the grid is feasible" in capsys.readouterr().err
    save_robot(round_hole(at=(9, 0, 0)), "free.toml")
    assert main(["surface", "free.toml", "--joints", *NAMES, "-o", "f.ply"]) == 0
    assert not (tmp_path / "f.ply").exists()
