"""The examples of docstrings run, and whatever a newcomer calls first has one."""

import doctest
import importlib
import inspect
from pathlib import Path

import pytest

import qbound

SOURCES = Path(qbound.__file__).parents[1]
FILES = [path for name in ("qbound", "lizarraga2025") for path in (SOURCES / name).rglob("*.py")]
MODULES = sorted(
    ".".join(path.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")
    for path in FILES
    if ">>>" in path.read_text(encoding="utf-8")
)
METHODS = [
    name
    for name, _ in inspect.getmembers(qbound.Region, inspect.isfunction)
    if not name.startswith("_")
]


@pytest.mark.parametrize("name", MODULES)
def test_examples_show_what_the_calls_return(name) -> None:
    failed, tried = doctest.testmod(importlib.import_module(name))
    assert tried
    assert not failed


@pytest.mark.parametrize("name", qbound.__all__)
def test_everything_at_the_front_door_has_an_example(name) -> None:
    assert ">>>" in (getattr(qbound, name).__doc__ or "")


@pytest.mark.parametrize("name", METHODS)
def test_every_method_of_a_region_has_an_example(name) -> None:
    assert ">>>" in (getattr(qbound.Region, name).__doc__ or "")


def test_there_are_modules_and_methods_to_look_at() -> None:
    assert {"qbound.region.region", "qbound.proofs.certify"} <= set(MODULES)
    assert {"margins", "contains", "plot", "to_dict"} <= set(METHODS)
