"""Vector labelling (Section 2, eqs. 1-8): frames, and vectors between them seen from a third frame.

One definition serves numbers and symbols: arrays of floats with any leading (batch) axes, or arrays
of SymPy expressions, so that the book can prove what the numbers show.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Array
from cspace.tolerances import ZERO_AMPLITUDE


@dataclass(frozen=True, eq=False)
class Frame:
    r"""The frame :math:`o_{a,b} = [R\ r]` (eq. 1): orientation and origin of b, seen from a.

    Attributes
    ----------
    name, parent : str
        Labels b and a, of any kind (rule 7 of Section 2); `parent` is a frame already known.
    rotation : ndarray, shape (..., 3, 3)
        Its columns are the unit vectors i, j, k of the frame (eq. 7).
    origin : ndarray, shape (..., 3)
        Length.
    """

    name: str
    parent: str
    rotation: Array
    origin: Array


class Frames:
    """A tree of frames that grows from one base: the labels of Section 2.

    Every vector here names its observer. The paper leaves the observer out where it is "common"
    (rule 5); its eqs. (15) and (25) then carry one label, seen from two frames.

    Parameters
    ----------
    base : str
        Label of the base frame.
    frames : iterable of Frame
        Each with a parent that is the base or comes before it.

    Raises
    ------
    ValueError
        If a label is used twice or a parent is unknown.
    """

    def __init__(self, base: str, frames: Iterable[Frame]) -> None:
        self.base = base
        self._parents: dict[str, str] = {}
        self._poses: dict[str, tuple[Array, Array]] = {
            base: (np.eye(3, dtype=int), np.zeros(3, int))
        }
        for frame in frames:
            self._add(frame)

    def _add(self, frame: Frame) -> None:
        if frame.name in self._poses:
            raise ValueError(f"the label {frame.name!r} is used twice")
        if frame.parent not in self._poses:
            raise ValueError(f"frame {frame.name!r}: its parent {frame.parent!r} is unknown")
        rotation, origin = self._poses[frame.parent]
        # Eq. (18), one step: r_{0,b} = r_{0,a} + R_{0,a} r_{a,b}, R_{0,b} = R_{0,a} R_{a,b}.
        self._poses[frame.name] = (
            rotation @ frame.rotation,
            origin + apply(rotation, frame.origin),
        )
        self._parents[frame.name] = frame.parent

    @property
    def names(self) -> tuple[str, ...]:
        """Labels in the order in which they were given, the base first."""
        return tuple(self._poses)

    def rotation(self, a: str, b: str) -> Array:
        """Return :math:`R_{a,b}`: it turns coordinates seen from b into those seen from a (eq. 1).

        Returns
        -------
        ndarray, shape (..., 3, 3)
        """
        return transpose(self._pose(a)[0]) @ self._pose(b)[0]

    def position(self, a: str, b: str, observer: str) -> Array:
        """Return :math:`r_{a,b}^{(c)}`: from the origin of a to that of b, seen from c (eqs. 3, 4).

        Returns
        -------
        ndarray, shape (..., 3)
            Length.
        """
        seen_from_base = self._pose(b)[1] - self._pose(a)[1]
        return apply(transpose(self._pose(observer)[0]), seen_from_base)

    def frame(self, a: str, b: str) -> Array:
        r"""Return :math:`o_{a,b} = [R_{a,b}\ r_{a,b}^{(a)}]`, shape (..., 3, 4) (eqs. 1, 2)."""
        rotation, origin = self.rotation(a, b), self.position(a, b, a)
        batch = np.broadcast_shapes(rotation.shape[:-2], origin.shape[:-1])
        columns = np.broadcast_to(rotation, (*batch, 3, 3)), np.broadcast_to(origin, (*batch, 3))
        return np.concatenate([columns[0], columns[1][..., None]], axis=-1)

    def unit_vector(self, a: str, b: str, observer: str) -> Array:
        """Return :math:`u_{a,b}^{(c)}`, shape (..., 3) (eq. 8).

        Raises
        ------
        ValueError
            If the two origins coincide: eq. (8) divides by their distance.
        """
        vector = self.position(a, b, observer)
        squared = np.asarray((vector * vector).sum(axis=-1), dtype=vector.dtype)
        if np.any(squared == 0):
            raise ValueError(f"the origins of {a!r} and {b!r} coincide: no direction (eq. 8)")
        length = np.asarray(squared ** _half(squared))
        return np.asarray(vector / length[..., None])

    def precedes(self, a: str, b: str) -> bool:
        """Tell whether a precedes b in the chain (eq. 5): b grows from a, directly or not."""
        self._pose(a), self._pose(b)
        parent = self._parents.get(b)
        return parent is not None and (parent == a or self.precedes(a, parent))

    def _pose(self, name: str) -> tuple[Array, Array]:
        try:
            return self._poses[name]
        except KeyError:
            raise ValueError(f"no frame {name!r}; there are {', '.join(self.names)}") from None


def axis_rotation(axis: ArrayLike, angle: Any) -> Array:
    """Rotation about a unit axis by Rodrigues' formula.

    Parameters
    ----------
    axis : array_like, shape (3,)
        Unit vector.
    angle : array_like of float, shape (...), or sympy.Expr
        rad.

    Returns
    -------
    ndarray, shape (..., 3, 3)
    """
    k = np.asarray(axis)
    along = np.outer(k, k)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    cosine, sine = (x[..., None, None] for x in _cos_sin(angle))
    return np.asarray(along + cosine * (np.eye(3, dtype=int) - along) + sine * cross)


def roll_pitch_yaw(roll: Any, pitch: Any, yaw: Any) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll), rad: the mount of a joint, as in URDF."""
    x, y, z = np.eye(3, dtype=int)
    return axis_rotation(z, yaw) @ axis_rotation(y, pitch) @ axis_rotation(x, roll)


def transpose(matrix: Array) -> Array:
    """Swap the last two axes."""
    return np.swapaxes(matrix, -1, -2)


def cross(a: Array, b: Array) -> Array:
    """Return cross products of vectors whose coordinates are the first axis, (3, ...)."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def apply(matrix: Array, vector: Array) -> Array:
    """Matrix times vector over leading axes: (..., 3, 3), (..., 3) -> (..., 3)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


def whole_numbers(values: Array) -> Array:
    """Make entries that are whole up to rounding exact, so that symbols meet no floats."""
    import sympy

    whole = np.rint(values).astype(int)
    exact = np.vectorize(sympy.Integer, otypes=[object])(whole)
    return np.where(np.abs(values - whole) <= ZERO_AMPLITUDE, exact, values)


def _cos_sin(angle: Any) -> tuple[Array, Array]:
    """Cosine and sine of floats, of balls, or of SymPy expressions."""
    angle = np.asarray(angle)
    if angle.dtype != object:
        return np.cos(angle), np.sin(angle)
    if all(hasattr(x, "sin_cos") for x in angle.flat):
        sine, cosine = np.frompyfunc(lambda x: x.sin_cos(), 1, 2)(angle)
        return np.asarray(cosine), np.asarray(sine)
    import sympy

    return tuple(np.vectorize(f, otypes=[object])(angle) for f in (sympy.cos, sympy.sin))


def _half(squared: Array) -> Any:
    """One half in the type of the given numbers; exact for symbols."""
    if squared.dtype != object:
        return 0.5
    import sympy

    return sympy.Rational(1, 2)
