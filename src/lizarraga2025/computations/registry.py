"""Which function computes which entry: every function names the ids that it answers for."""

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from pkgutil import iter_modules
from typing import Final, TypeVar

from lizarraga2025.verdicts import Outcome

Computation = Callable[[], Outcome]
Case = TypeVar("Case")

PACKAGES: Final = ("lizarraga2025.computations", "lizarraga2025.beyond")
"""Those of the second need the engine."""

_BY_ID: dict[str, Computation] = {}


def computes(*names: str) -> Callable[[Computation], Computation]:
    """Register a function for an entry, or for several that it answers alike.

    Raises
    ------
    ValueError
        If another function answers for an id.
    """

    def register(function: Computation) -> Computation:
        for name in names:
            if name in _BY_ID:
                raise ValueError(f"two functions compute the entry {name}")
            _BY_ID[name] = function
        return function

    return register


def computes_each(
    cases: Mapping[str, Case],
) -> Callable[[Callable[[Case], Outcome]], Callable[[Case], Outcome]]:
    """Register a function for several entries of a kind, each with what it is called with."""

    def register(function: Callable[[Case], Outcome]) -> Callable[[Case], Outcome]:
        for name, case in cases.items():
            computes(name)(partial(function, case))
        return function

    return register


def by_id() -> Mapping[str, Computation]:
    """Return the function of every entry; a module registers its own when imported."""
    for package in PACKAGES:
        for module in iter_modules(import_module(package).__path__):
            import_module(f"{package}.{module.name}")
    return _BY_ID
