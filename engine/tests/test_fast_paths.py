"""What was made fast says what the plain way says: quadrature, products, pairs, commands."""

import gc
import re
import subprocess
import sys
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cspace
from cspace import find_region, load_robot
from cspace.arrays import cross
from cspace.cli import COMMANDS, command_line, command_parsers, main
from cspace.forms.factors import basis_and_slope, basis_slope
from cspace.measures import nearest
from cspace.region import events
from cspace.region.events import Events, Finder, _Request, find_events
from cspace.region.outline import CELL_NODES, NODES, _smooth_rules, legendre
from cspace.region.plane import HIGHEST, LOWEST, Plane, Precise, Root, runs
from cspace.region.problem import clearance_problem
from engine_support.forms import ROUND, RR, forms
from engine_support.regions import problem_of
from qbound.forms import basis


@pytest.mark.parametrize("n", [1, 2, 5, *CELL_NODES[:4]])
def test_nodes_are_those_of_numpy_and_integrate_exactly(n):
    x, w = legendre(n)
    nodes, weights = np.polynomial.legendre.leggauss(n)
    assert_allclose(x, nodes, atol=4e-16)
    assert_allclose(w, weights, atol=1e-14)
    k = np.arange(2 * n)
    assert_allclose(x ** k[:, None] @ w, np.where(k % 2, 0, 2 / (k + 1)), atol=1e-14)


def test_cells_are_measured_with_more_nodes_each_time():
    assert CELL_NODES[0] == NODES[0]
    assert all(np.diff(CELL_NODES) > 0)


def test_two_rules_in_one_call_are_both():
    sines, weights = _smooth_rules((24, 32))
    height = np.sqrt(1 - sines**2) * (0.3 + 0.5 * sines)  # a fold at either end
    assert height @ weights == pytest.approx([0.15 * np.pi] * 2, abs=1e-14)
    for n, own in zip((24, 32), weights.T, strict=True):
        alone, (part,) = _smooth_rules((n,))[0], _smooth_rules((n,))[1].T
        assert (sines[own != 0] == alone).all()
        assert (own[own != 0] == part).all()


@pytest.mark.parametrize("values", [[], [3], [1, 1, 2, 2, 2, 0], [5, 4, 4]])
def test_runs_are_those_of_groupby(values):
    rows = [[i for i, _ in own] for _, own in groupby(enumerate(values), key=lambda pair: pair[1])]
    first, last = runs(np.array(values, dtype=np.int64))
    assert first.tolist() == [own[0] for own in rows]
    assert last.tolist() == [own[-1] for own in rows]


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


@pytest.mark.parametrize("count", [3, 300])
def test_products_of_polynomials_few_or_many(count):
    rng = np.random.default_rng(0)
    p, q = (rng.normal(size=(count, n, 2)) @ [1, 1j] for n in (3, 5))
    found = events._times(p, q)
    for one, other, product in list(zip(p, q, found, strict=True))[:5]:
        assert_allclose(product, np.convolve(one, other), atol=1e-13)


def test_events_solved_together_are_those_solved_alone():
    rng = np.random.default_rng(1)
    precise = Precise.of(problem_of(forms(RR, {"00": 1.0, "11": 2.0}), ROUND), 0)
    finder, kinds = Finder(precise.plane, precise), ("constant", "second", "resultant circle")
    stacks = [rng.normal(size=(4, n)) + 1j * rng.normal(size=(4, n)) for n in (3, 5, 9)]
    stacks = [stack + np.conj(stack[:, ::-1]) for stack in stacks]  # with roots on the circle
    requests = [
        _Request(kind, np.arange(4), np.arange(4), stack, np.full(4, 1e-14))
        for kind, stack in zip(kinds, stacks, strict=True)
    ]
    together = finder.events(requests)
    alone = [finder.events([request]) for request in requests]
    assert len(together) == sum(map(len, alone)) > 3
    rows = (np.column_stack([e.what, e.t]) for e in (together, Events.joined(alone)))
    one, other = (np.array(sorted(own.tolist())) for own in rows)
    assert_allclose(one, other, atol=1e-12)


def test_several_roots_over_the_same_values_are_those_one_by_one():
    plane = Plane(forms(RR, {(0, 0): 0.3, (1, 1): 1.0, (0, 2): 1.0}), (None, (-1.0, 2.0)), 0)
    t = np.linspace(-1, 1, 12).reshape(3, 4)
    roots = np.array([[Root(0, -1), Root(0, 1), LOWEST], [HIGHEST, Root(0, 1, 1), Root(0, -1)]])
    found = plane.follow(roots, t)
    assert found.shape == (2, 3, 4)
    for i, k in np.ndindex(2, 3):
        assert_allclose(found[i, k], plane.follow([Root(*roots[i, k])], t[[k]])[0], atol=0)
    assert (found[0, 2] == -1.0).all()
    assert (found[1, 0] == 2.0).all()


def test_pieces_are_paired_the_same_in_blocks_of_any_size(monkeypatch):
    precise = Precise.of(clearance_problem(load_robot("two-links-on-a-table")), 0)

    def critical_values():
        lines, _ = find_events(precise)
        return lines.t

    whole = critical_values()
    monkeypatch.setattr(events, "PAIRS", 50)
    assert (critical_values() == whole).all()


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_factors_and_slopes_in_one_array(kind):
    q = np.linspace(-2, 2, 6).reshape(2, 3)
    found = basis_and_slope(kind, q)
    assert_allclose(found[..., 0, :], basis(kind, q), atol=0)
    assert_allclose(found[..., 1, :], basis_slope(kind, q), atol=0)


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


def test_a_region_that_is_found_again_runs_through_few_files():
    """Somebody who mends a region reads these files: six of them are the region's own."""
    robot, root, files = load_robot("minervabot-v2"), Path(cspace.__file__).parent, set()

    def entered(frame, event, _):
        file = Path(frame.f_code.co_filename)
        if root in file.parents:
            files.add(file.relative_to(root).as_posix())

    find_region(robot)  # the robot's forms, once
    before = sys.gettrace()
    sys.settrace(entered)
    find_region(robot)
    sys.settrace(before)
    own = {"problem", "plane", "events", "cells", "outline", "region"}
    assert {file for file in files if file.startswith("region/")} == {
        f"region/{name}.py" for name in own
    }
    assert len(files) <= 13, sorted(files)
