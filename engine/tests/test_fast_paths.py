"""What was made fast says what the plain way says: quadrature, blocks, commands."""

import gc
import re
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cspace
from cspace import find_region, load_robot
from cspace.arrays import cross
from cspace.cli import COMMANDS, command_line, command_parsers, main
from cspace.forms.factors import basis_and_slope
from cspace.measures import nearest
from cspace.region import cells, zeros
from cspace.region.places import smooth_rules
from qbound.forms import DERIVATIVES, basis


def test_two_rules_in_one_call_are_both():
    sines, weights = smooth_rules((24, 32))
    height = np.sqrt(1 - sines**2) * (0.3 + 0.5 * sines)  # a fold at either end
    assert height @ weights == pytest.approx([0.15 * np.pi] * 2, abs=1e-14)
    for n, own in zip((24, 32), weights.T, strict=True):
        alone, (part,) = smooth_rules((n,))[0], smooth_rules((n,))[1].T
        assert (sines[own != 0] == alone).all()
        assert (own[own != 0] == part).all()


@pytest.mark.parametrize("name", ["minervabot-v2", "two-links-on-a-table", "pp-portal"])
def test_a_loop_begins_at_its_lowest_vertex_and_vertices_are_where_labels_change(name):
    for component in find_region(load_robot(name)).components:
        found = iter(component.vertices)
        for loop in component.loops:
            corners = [
                (arc.start, (before.boundary, arc.boundary))
                for before, arc in zip((loop[-1], *loop), loop, strict=False)
                if before.label != arc.label
            ]
            own = [next(found) for _ in corners]
            assert [vertex.boundaries for vertex in own] == [names for _, names in corners]
            assert all((vertex.q == q).all() for vertex, (q, _) in zip(own, corners, strict=True))
            if corners and np.abs(loop[-1].end - loop[0].start).max() < np.pi:
                places = [q[::-1].round(9).tolist() for q, _ in corners]
                assert (loop[0].start == corners[0][0]).all()
                assert places[0] == min(places)
        assert next(found, None) is None


@pytest.mark.parametrize("name", ["two-links-on-a-table", "two-joint-arm-with-walls"])
def test_a_region_is_the_same_in_blocks_of_any_size(name, monkeypatch):
    robot = load_robot(name)
    whole = find_region(robot)
    monkeypatch.setattr(zeros, "CHUNK", 16)
    monkeypatch.setattr(cells, "BLOCK", 50)
    parts = find_region(robot)
    assert parts == whole
    for one, other in zip(whole.components, parts.components, strict=True):
        assert other.area == pytest.approx(one.area, rel=1e-12)
        for v, w in zip(one.vertices, other.vertices, strict=True):
            assert v.boundaries == w.boundaries
            assert_allclose(v.q, w.q, atol=1e-9)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_factors_and_slopes_in_one_array(kind):
    q = np.linspace(-2, 2, 6).reshape(2, 3)
    found = basis_and_slope(kind, q)
    assert_allclose(found[..., 0, :], basis(kind, q), atol=0)
    assert_allclose(found[..., 1, :], basis(kind, q) @ DERIVATIVES[kind].T, atol=0)


def test_a_cross_product_of_stacks():
    a, b = np.random.default_rng(2).normal(size=(2, 3, 4))
    assert_allclose(cross(a, b), np.cross(a, b, axis=0), atol=1e-15)
    assert_allclose(cross(a[:, 0], b), np.cross(a[:, 0], b, axisb=0, axisc=0), atol=1e-15)


def test_the_nearest_point_is_found_in_few_rounds(monkeypatch):
    region, rounds, slope = find_region(load_robot("minervabot-v2")), [0], nearest._slope

    def counted(*arguments):
        rounds[0] += 1
        return slope(*arguments)

    monkeypatch.setattr(nearest, "_slope", counted)
    nearest.nearest_boundary(region, [0.35, -0.78], 0)
    assert rounds[0] < 30  # sixty each, where rounding alone was left to search


# --- commands -------------------------------------------------------------------------------------


def test_a_command_alone_has_the_help_that_it_has_among_all():
    every = command_parsers()
    assert [*every][: len(COMMANDS)] == [*COMMANDS]
    for name in ("contains", "import", "certify"):
        (alone,) = (
            action.choices for action in command_line(name)._actions if action.choices is not None
        )
        assert [*alone] == [name]
        assert alone[name].format_help() == every[name].format_help()


def test_contains_imports_what_it_needs():
    heavy = re.compile(
        r"cspace\.(proofs|arms\.(?!links)\w+|explorer|figures|sweeps|urdf|workspace|paths)"
        r"|importlib\.(metadata|resources)|numpy\.(ma|polynomial)|email|csv|json"
        r"|shutil|threading"
    )
    code = (
        "import sys; before = {*sys.modules}; from cspace.cli import main; "
        "status = main(['contains', 'minervabot-v2', '20deg', '-45deg']); "
        "print(status, *{*sys.modules} - before)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    status, *modules = done.stdout.splitlines()[-1].split()
    assert status == "0"
    assert [name for name in modules if heavy.fullmatch(name)] == []


def test_a_process_of_its_own_answers_as_a_call_does(capsys):
    words = ["contains", "minervabot-v2", "100deg", "20deg"]
    command = [sys.executable, "-W", "error", "-m", "cspace", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert gc.isenabled()
    assert (main(words), *capsys.readouterr()) == (done.returncode, done.stdout, done.stderr)
    assert done.returncode == 1


def test_a_process_looks_for_garbage_while_it_works_and_only_then(monkeypatch):
    looking = []

    def run(options):
        looking.append(gc.isenabled())
        return 0

    monkeypatch.setattr("sys.argv", ["cspace", "robots"])
    monkeypatch.setattr("cspace.cli.robots.run", run)
    monkeypatch.setattr(gc, "freeze", lambda: looking.append("kept"))
    assert main() == 0
    assert looking == ["kept", True, "kept"]


def test_the_version_is_told(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr() == (f"cspace {cspace.__version__}\n", "")
