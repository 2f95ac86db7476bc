"""The library as a whole: it loads little, and it draws."""

import subprocess
import sys

import numpy as np

import qbound
from qbound import figures


def test_importing_loads_neither_sympy_nor_matplotlib():
    code = "import qbound, sys; print(*(m for m in ('sympy', 'matplotlib') if m in sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ""


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
