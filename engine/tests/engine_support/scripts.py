"""Scripts of the repository that belong to no package, as modules."""

import ast
import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ("tests", "engine/tests")
"""Of all tests; no two files of them have one name."""


@contextmanager
def importable(folder: Path) -> Iterator[None]:
    """Let the modules of a folder be imported; at the end they are forgotten again.

    Another copy of them, or another order of the tests, then finds the process as it was.
    """
    known = set(sys.modules)
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        if str(folder) in sys.path:
            sys.path.remove(str(folder))
        for name in set(sys.modules) - known:
            if lies_in(folder, sys.modules[name]):
                del sys.modules[name]


def lies_in(folder: Path, module: ModuleType) -> bool:
    """Tell whether a module comes from a folder; a package without a file of its own, too."""
    places = [vars(module).get("__file__") or "", *vars(module).get("__path__", [])]
    return any(Path(place).is_relative_to(folder) for place in places)


def load_script(name: str) -> ModuleType:
    """A fresh copy of a script, by its path in the repository, so that a test may change it."""
    path = ROOT / name
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    assert module.__name__ not in sys.modules
    with importable(path.parent):
        spec.loader.exec_module(module)
    return module


@cache
def names_of_tests(file: str) -> frozenset[str]:
    """The functions of a file of tests, by its name."""
    [path] = [path for folder in FOLDERS for path in (ROOT / folder).rglob(file)]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return frozenset(node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))
