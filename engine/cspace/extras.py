"""Optional libraries: which call needs which, and which extra installs it."""

import sys
from importlib.util import find_spec
from typing import Final, NamedTuple


class Extra(NamedTuple):
    """An optional library: its use, its name, the extra of `pyproject.toml` that installs it."""

    taker: str
    library: str
    name: str


EXTRAS: Final = {
    "distributed": Extra("a sweep", "Dask", "cluster"),
    "lxml": Extra("reading a URDF", "lxml", "arms"),
    "numba": Extra("machine code", "Numba", "compiled"),
    "scipy": Extra("a connection by cells", "SciPy", "proofs"),
    "shapely": Extra("a polygon of shapely", "shapely", "polygons"),
    "tomlkit": Extra("writing a robot file", "tomlkit", "files"),
    "trimesh": Extra("a mesh", "trimesh", "arms"),
}
"""By the name that is imported."""


def require(module: str, taker: str | None = None) -> None:
    """Raise an error that says how to install a module of `EXTRAS`, if it is missing.

    Parameters
    ----------
    taker : str, optional
        The call that needs the module, for the message; default: its usual use.

    Raises
    ------
    ModuleNotFoundError
        Such as "a sweep takes Dask: pip install 'cspace[cluster]'".
    """
    if module not in sys.modules and find_spec(module) is None:
        raise ModuleNotFoundError(how_to_install(module, taker), name=module)


def how_to_install(module: str, taker: str | None = None) -> str:
    """Return the sentence how to install a module of `EXTRAS`, for the given use."""
    extra = EXTRAS[module]
    return f"{taker or extra.taker} takes {extra.library}: pip install 'cspace[{extra.name}]'"


def explained(error: Exception) -> str:
    """Return the message of an error; for a missing module of `EXTRAS`, how to install it."""
    if isinstance(error, OSError) and error.strerror:  # without its number and quotes
        where = "" if error.filename is None else f"{error.filename}: "
        return f"{where}{error.strerror}"
    module = (getattr(error, "name", None) or "").partition(".")[0]
    missing = isinstance(error, ModuleNotFoundError) and module in EXTRAS
    ours = missing and "pip install" in str(error)  # the message of `require` names the use
    return how_to_install(module) if missing and not ours else str(error)
