"""What some calls need and a plain install does not bring: which extra brings it, and how."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from typing import Final, NamedTuple


class Extra(NamedTuple):
    """A library: what takes it, its name, and the extra of `pyproject.toml` that brings it."""

    taker: str
    library: str
    name: str


EXTRAS: Final = {
    "IPython": Extra("a table in Jupyter", "IPython", "notebooks"),
    "flint": Extra("a proof in ball arithmetic", "python-flint", "proofs"),
    "matplotlib": Extra("drawing", "matplotlib", "figures"),
    "matplotlib_inline": Extra("a figure in Jupyter", "matplotlib-inline", "notebooks"),
    "scipy": Extra("a connection by cells", "SciPy", "proofs"),
    "shapely": Extra("a polygon of shapely", "shapely", "proofs"),
    "skimage": Extra("a surface or a count on a grid", "scikit-image", "notebooks"),
    "sympy": Extra("a formula", "SymPy", "symbolic"),
    "tomlkit": Extra("writing a robot file", "tomlkit", "files"),
}
"""By the name that is imported."""


def require(module: str) -> None:
    """Raise an error that says how to install a module of `EXTRAS`, if it is missing.

    Raises
    ------
    ModuleNotFoundError
        Such as "drawing takes matplotlib: pip install 'qbound[figures]'".
    """
    if module not in sys.modules and find_spec(module) is None:
        raise ModuleNotFoundError(how_to_install(module), name=module)


def how_to_install(module: str) -> str:
    """Return the sentence for a module of `EXTRAS`."""
    extra = EXTRAS[module]
    return f"{extra.taker} takes {extra.library}: pip install 'qbound[{extra.name}]'"


def explained(error: Exception) -> str:
    """Return what an error says; for a missing module of `EXTRAS`, how to install it."""
    module = (getattr(error, "name", None) or "").partition(".")[0]
    missing = isinstance(error, ModuleNotFoundError) and module in EXTRAS
    return how_to_install(module) if missing else str(error)
