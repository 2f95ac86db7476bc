"""The library as a whole: its examples run, it stands alone, it loads little, it draws."""

import ast
import doctest
import importlib
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import qbound
from qbound import figures

MODULES = sorted(path.stem for path in Path(qbound.__file__).parent.glob("*.py"))
ALLOWED = {"numpy", "sympy", "matplotlib", "matplotlib_inline", "IPython", "qbound"}


@pytest.mark.parametrize("name", MODULES)
def test_an_example_of_a_docstring_runs_as_it_is_copied(name):
    module = qbound if name == "__init__" else importlib.import_module(f"qbound.{name}")
    for example in doctest.DocTestFinder().find(module, module.__name__, globs={"np": np}):
        assert doctest.DocTestRunner().run(example).failed == 0


@pytest.mark.parametrize("name", MODULES)
def test_a_module_imports_numpy_sympy_matplotlib_and_modules_before_it(name):
    path = Path(qbound.__file__).parent / f"{name}.py"
    for node in ast.walk(ast.parse(path.read_text())):
        modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        modules += [node.module] if isinstance(node, ast.ImportFrom) else []
        for module in modules:
            assert module.partition(".")[0] in ALLOWED | set(sys.stdlib_module_names)


def test_a_module_uses_modules_before_it_in_the_order_of_reading():
    order = re.findall(r"`(\w+)`", qbound.__doc__)
    assert sorted(order) == [name for name in MODULES if name != "__init__"]
    for name in order:
        text = (Path(qbound.__file__).parent / f"{name}.py").read_text()
        tree = ast.parse(text)
        lines = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        used = [line.module.removeprefix("qbound.") for line in lines if "qbound." in line.module]
        assert all(order.index(module) < order.index(name) for module in used), name


def test_importing_loads_neither_sympy_nor_matplotlib():
    code = "import qbound, sys; print(*(m for m in ('sympy', 'matplotlib') if m in sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ""


def test_every_public_name_is_there_and_has_an_example():
    for name in qbound.__all__:
        assert getattr(qbound, name).__doc__
    assert sorted(qbound.__all__) == qbound.__all__


def test_everything_is_drawn():
    from matplotlib.figure import Figure

    robot = qbound.load_robot("minervabot-v2")
    region = qbound.window_region(robot)
    path = qbound.traverse(robot, region.polygon, closed=True)
    square = [(-np.pi, np.pi)] * 2
    axes = Figure().subplots(1, 3)
    height = qbound.clearance(robot, robot.boundary("B7"))
    figures.draw_zero(axes[0], robot, height, square, colors=figures.USED)
    figures.draw_bound(axes[0], robot, region.polygon, used=False)
    assert figures.draw_vertices(axes[0], robot, region.polygon)
    look = {"ranges": square, "window": [(-60, 60), (0, 80)], "labels": "123456"}
    assert figures.draw_traversal(axes[:2], robot, region.polygon, path, **look)
    assert figures.draw_robot(axes[1], robot, robot.home, points=("10", "11"))
    assert figures.draw_arrow(axes[1], [0, 0], [1, 2], "r")
    drawn = qbound.sample(robot, 50, qbound.keeps_clear)
    figures.draw_sample(axes[2], drawn.q, drawn.allowed)
    figures.legend_below(axes[2])
    assert figures.boundary_colour(robot, "B7") == figures.BOUNDARIES[6]
    assert figures.bound_label("beta_{1,3,1}") == r"$\beta_{1,3,1}$"
    axes[0].figure.canvas.draw()


def test_a_joint_that_slides_has_an_axis_of_lengths():
    from dataclasses import replace

    from matplotlib.figure import Figure

    robot = qbound.load_robot("minervabot-v2")
    sliding = replace(robot.joints[1], kind="prismatic", limits=(0.0, 9.0))
    ax = Figure().subplots()
    arm = replace(robot, joints=(robot.joints[0], sliding))
    figures.joint_axes(ax, arm)
    assert ax.get_ylabel() == "$q_2$ / cm"
    assert ax.get_ylim() == (0.0, 9.0)
    assert figures.shown(arm, [np.pi, 5.0]).tolist() == [180.0, 5.0]
