"""Importing the package stays light: what only some calls need is loaded by those calls."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ["sympy", "matplotlib", "jsonschema", "scipy", "shapely", "IPython", "pandas", "flint"]
HEAVY += ["tomlkit"]
SHOW = "import sys, json; print(json.dumps(sorted({m.split('.')[0] for m in sys.modules})))"


def loaded_by(code: str) -> set[str]:
    """Top-level modules of a fresh interpreter after some code."""
    run = [sys.executable, "-c", f"{code}\n{SHOW}"]
    return set(json.loads(subprocess.run(run, capture_output=True, check=True).stdout))


def test_import_loads_no_heavy_module() -> None:
    assert not loaded_by("import qbound") & {"numpy", "msgspec", *HEAVY}
    modules = loaded_by("from qbound import *")
    assert {"qbound", "numpy"} <= modules
    assert not modules & set(HEAVY)


def test_every_module_of_the_package_imports_without_the_heavy_ones() -> None:
    code = (
        "import importlib, pkgutil, qbound\n"
        "for m in pkgutil.iter_modules(qbound.__path__):\n"
        "    importlib.import_module('qbound.' + m.name)"
    )
    assert not loaded_by(code) & set(HEAVY)


def test_numbers_never_call_sympy() -> None:
    """From the file to the vertices and a sample: the file is checked, no symbol is made."""
    modules = loaded_by(
        "import qbound, numpy\n"
        "from qbound import sampling\nfrom lizarraga2025 import closed_form\n"
        "from qbound.paths import traversal\n"
        "robot = qbound.load_robot('minervabot-v2')\n"
        "q = [v.q for v in closed_form.vertices(robot)]\n"
        "traversal.traverse(robot, q)\n"
        "sampling.sample(robot, 10, sampling.keeps_clear, seed=1)"
    )
    assert "msgspec" in modules
    assert not modules & {"sympy", "matplotlib", "jsonschema", "tomlkit"}


@pytest.mark.parametrize(
    "name", ["HarmonicForm", "Robot", "load_robot", "is_feasible", "clearance"]
)
def test_the_front_door_holds_what_a_reader_needs_first(name) -> None:
    import qbound

    assert name in qbound.__all__
    assert all(hasattr(qbound, exported) for exported in qbound.__all__)


def test_the_front_door_opens_on_what_type_checkers_see() -> None:
    import qbound

    tree = ast.parse(Path(qbound.__file__).read_text(encoding="utf-8"))
    [seen] = [
        node
        for node in tree.body
        if isinstance(node, ast.If)
        and "TYPE" in ast.unparse(node.test)
        and not isinstance(node.test, ast.UnaryOp)
    ]
    imports = [node for node in seen.body if isinstance(node, ast.ImportFrom)]
    told = {node.module: tuple(name.name for name in node.names) for node in imports}
    places = {f"qbound.{place}": names for place, names in qbound._PLACES.items()}
    assert places == told | {"qbound.version": ("__version__",)}
    assert sorted(name for names in told.values() for name in names) == qbound.__all__
    assert {*dir(qbound)} == {*qbound.__all__, "__version__"}
    assert qbound.units.__name__ == "qbound.units"
    with pytest.raises(AttributeError, match="'qbound' has no attribute 'find_regions'"):
        qbound.find_regions  # noqa: B018


def test_version_is_that_of_the_metadata() -> None:
    import tomllib

    import qbound

    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text("utf-8"))
    assert qbound.__version__ == project["project"]["version"]
