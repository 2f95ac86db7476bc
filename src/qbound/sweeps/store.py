"""The folder of a sweep: its specification, and its values as Zarr chunks, each written once.

- ``specification.json``: what is swept, with the robot and the versions, written first;
- ``values.zarr``: a group of Zarr 3 with an array a measure, an array a varied number, and
  `reason`: why a value is NaN. A chunk is a file that appears whole, renamed when it is written;
- ``summary.json``: written last, when no chunk is missing.

The files do not record when, where or by how many workers they were made.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET
from numpy.typing import NDArray

from qbound.extras import require
from qbound.files import write_whole
from qbound.model.robotfile import robot_table
from qbound.model.schema import one_line
from qbound.printable import printable
from qbound.sweeps import specification as grid
from qbound.sweeps.measures import HELD, MEASURES, Measured, unit_of, versions
from qbound.sweeps.specification import Study, held_names
from qbound.units import file_units

SCHEMA = "qbound/sweep/1"
ABOUT, VALUES, SUMMARY = "specification.json", "values.zarr", "summary.json"
REASON = "reason"
EMPTY_TOO = {"array.write_empty_chunks": True}
"""A chunk that holds nothing is a file too: that it is there says that it was measured."""


class OtherSweepError(ValueError):
    """Error: a folder holds something else than this sweep; the message says what differs."""


@dataclass(frozen=True, eq=False)
class Store:
    """The folder of a sweep, begun by `begin`."""

    study: Study
    folder: Path

    @cached_property
    def arrays(self) -> dict[str, Any]:
        """The arrays by their names, made where they are missing."""
        import zarr

        place = self.folder / VALUES
        with zarr.config.set(EMPTY_TOO):  # no metadata: it is read when an array is opened
            group = zarr.open_group(place, mode="a", zarr_format=3)
            arrays: dict[str, Any] = {
                name: group[name] if name in group else group.create_array(name, **settings)
                for name, settings in _arrays(self.study).items()
            }
        for k, values in enumerate(grid.axes(self.study.specification)):
            if not (place / f"vary.{k}" / "c" / "0").is_file():
                arrays[f"vary.{k}"][:] = values
        return arrays

    @property
    def names(self) -> list[str]:
        """Arrays that have a chunk each for every job, the last of them written last."""
        return [*self.study.specification.measure, REASON]

    def has(self, chunk: grid.Chunk) -> bool:
        """Tell whether every array has a chunk."""
        place = "/".join(map(str, chunk))
        return all((self.folder / VALUES / name / "c" / place).is_file() for name in self.names)

    def write(self, chunk: grid.Chunk, measured: Measured) -> None:
        """Write a chunk, the reasons last."""
        part = grid.window(self.study.specification, chunk)
        size = tuple(piece.stop - piece.start for piece in part)
        values = np.array(measured.values, dtype="<f8")
        for k, name in enumerate(self.study.specification.measure):
            self.arrays[name][part] = values[:, k].reshape(size)
        reasons = np.array(measured.reasons, dtype=np.dtypes.StringDType())
        self.arrays[REASON][part] = reasons.reshape(size)

    def values(self, measure: str) -> NDArray[np.float64]:
        """Return a measure over the grid; NaN where it is missing or refused."""
        return np.asarray(self.arrays[measure][:], dtype=float)

    def reasons(self) -> dict[tuple[int, ...], str]:
        """Return why arms have no value, by their index on each axis."""
        found = np.asarray(self.arrays[REASON][:], dtype=object)
        return {index: str(found[index]) for index in np.ndindex(found.shape) if found[index]}

    def finish(self) -> None:
        """Write the summary; every chunk is there."""
        content = summary(self.study, self.reasons())
        write_whole(self.folder / SUMMARY, _json(content))


def begin(study: Study, folder: str | Path) -> Store:
    """Make the folder of a sweep, or open it to continue.

    Raises
    ------
    OtherSweepError
        If the folder holds another sweep, or holds no sweep and is not empty.
    OSError
        If the folder cannot be made.
    """
    require("zarr")
    path = Path(folder)
    if path.exists() and not path.is_dir():
        raise OtherSweepError(printable(f"{folder}: is no folder"))
    if not (path / ABOUT).is_file():
        if path.is_dir() and any(path.iterdir()):
            text = f"{folder}: holds files, and no sweep; wanted: a folder that is new or empty"
            raise OtherSweepError(printable(text))
        path.mkdir(exist_ok=True)
        write_whole(path / ABOUT, _json(about(study)))
    _check_same(study, path)
    return Store(study, path)


def about(study: Study) -> dict[str, Any]:
    """Return what identifies a sweep, as plain data; equal data mean the same sweep."""
    return {
        "schema": SCHEMA,
        "versions": versions(),
        "specification": msgspec.to_builtins(study.specification),
        "robot": robot_table(study.robot),
    }


def summary(study: Study, reasons: Mapping[tuple[int, ...], str]) -> dict[str, Any]:
    """Return the content of ``summary.json``."""
    specification = study.specification
    first = specification.measure[0]
    return {
        **about(study),
        "shape": list(grid.shape(specification)),
        "vary": [_axis(study, k) for k in range(len(specification.vary))],
        "measures": [
            {"name": name, "unit": measure_unit(study, name), "says": MEASURES[name].says}
            for name in specification.measure
        ],
        "not_measured": [
            {"index": list(index), "reason": reason} for index, reason in reasons.items()
        ],
        "open": f"zarr.open_group({VALUES!r}, mode='r')[{first!r}][:]",
    }


# --- what differs ---------------------------------------------------------------------------------


def _check_same(study: Study, path: Path) -> None:
    try:
        found = json.loads((path / ABOUT).read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        raise OtherSweepError(printable(f"{path / ABOUT}: is no JSON of a sweep")) from None
    wanted = json.loads(_json(about(study)))
    if found != wanted:
        where = _difference(found, wanted)
        text = f"{path}: holds another sweep ({where}); name another folder"
        raise OtherSweepError(printable(text))


def _difference(found: Any, wanted: Any, where: str = "") -> str:
    """Say where two contents differ first, and how."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        pairs = [(key, found.get(key), wanted.get(key)) for key in [*wanted, *found]]
    elif isinstance(found, list) and isinstance(wanted, list) and len(found) == len(wanted):
        pairs = [(str(i), *pair) for i, pair in enumerate(zip(found, wanted, strict=True))]
    else:
        there, here = one_line(json.dumps(found)), one_line(json.dumps(wanted))
        return f"{where.lstrip('.')}: {there} there, {here} here"
    key, one, other = next(pair for pair in pairs if pair[1] != pair[2])
    return _difference(one, other, f"{where}.{key}")


# --- what the arrays are --------------------------------------------------------------------------


def _arrays(study: Study) -> dict[str, dict[str, Any]]:
    """Return the settings of every array; no compression, so all versions write equal bytes."""
    specification = study.specification
    shape, chunks = grid.shape(specification), grid.chunk_shape(specification)
    names = [f"vary.{k}" for k in range(len(shape))]
    over = {"shape": shape, "chunks": chunks, "compressors": None, "dimension_names": names}
    number = {"dtype": "<f8", "fill_value": float("nan")}
    found = {
        f"vary.{k}": {
            **number,
            "compressors": None,
            "shape": (count,),
            "chunks": (count,),
            "dimension_names": [names[k]],
            "attributes": _axis(study, k),
        }
        for k, count in enumerate(shape)
    }
    for name in specification.measure:
        about = {"unit": measure_unit(study, name), "says": MEASURES[name].says}
        found[name] = {**over, **number, "attributes": about}
    found[REASON] = {**over, "dtype": "string", "fill_value": ""}
    return found


def _axis(study: Study, k: int) -> dict[str, Any]:
    """Return the description of an axis: the numbers that change along it, and their unit."""
    row = study.specification.vary[k]
    return {"numbers": row.numbers, "unit": number_unit(study, row.number)}


def number_unit(study: Study, name: str) -> str:
    """Return the unit of a number of the robot file: of an angle, a length or neither (``1``)."""
    robot = study.robot
    if name.startswith((HELD, "home.")):
        return file_units(robot)[robot.joint_index(name.partition(".")[2])]
    kind, joint, key, *_ = [*name.split("."), "", ""]
    if kind == "joint":
        units = {"origin": robot.length_unit, "rpy": robot.angle_unit, "axis": "1"}
        own = file_units(robot)[robot.joint_index(joint)]
        return units.get(key, f"{own}/s" if key == "velocity" else own)
    return "1" if key == "normal" else robot.length_unit


def measure_unit(study: Study, measure: str) -> str:
    """Return the unit of a measure; ``1`` for a plain number."""
    held = {study.robot.joint_index(name) for name in held_names(study.specification)}
    fibre = study.specification.fibre
    moving = None if fibre is UNSET else study.robot.joint_index(fibre)
    return unit_of(MEASURES[measure], study.robot, study.robot.free(held), moving)


def _json(content: Mapping[str, Any]) -> bytes:
    return (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode()
