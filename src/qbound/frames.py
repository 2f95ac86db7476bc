"""Vector labels (Section 2, eqs. 1-8): frames, and vectors between them seen from a third frame.

One definition serves numbers and symbols: arrays of floats with leading axes for many
configurations, or arrays of SymPy expressions.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Array, cos_sin, cross_matrix, square_root, times

IDENTITY = np.eye(3, dtype=int)
"""The identity matrix in whole numbers, because symbols stay exact with them."""


@dataclass(frozen=True, eq=False)
class Frame:
    r"""The frame :math:`o_{a,b} = [R_{a,b}\ r_{a,b}]` (eq. 1): pose of frame b, seen from frame a.

    Attributes
    ----------
    name : str
        Label b: any text, not only a number (rule 7 of Section 2).
    parent : str
        Label a.
    rotation : ndarray, shape (..., 3, 3)
        Its columns are the unit vectors i, j, k of frame b, seen from frame a (eq. 7).
    origin : ndarray, shape (..., 3)
        Position of the origin of frame b, seen from frame a; in one unit of length.

    Examples
    --------
    >>> from qbound import Frame
    >>> Frame("1", "0", np.eye(3), np.array([0.0, 0.0, 22.5])).origin.tolist()
    [0.0, 0.0, 22.5]
    """

    name: str
    parent: str
    rotation: Array
    origin: Array


class Frames:
    r"""A tree of frames that grows from one base. Every vector names its observer.

    Parameters
    ----------
    base : str
        Label of the base frame.
    frames : iterable of Frame
        Each parent is the base or a frame before.

    Raises
    ------
    ValueError
        If a label is used twice or a parent is unknown. The methods raise it for an unknown label.

    Examples
    --------
    Frame b is 2 along the y axis of frame a, which is turned by a quarter about the base's z axis:

    >>> from qbound import Frame, Frames
    >>> from qbound.frames import axis_rotation
    >>> quarter = axis_rotation([0, 0, 1], np.pi / 2)
    >>> frames = Frames(
    ...     "0",
    ...     [
    ...         Frame("a", "0", quarter, np.array([5.0, 0.0, 0.0])),
    ...         Frame("b", "a", np.eye(3), np.array([0.0, 2.0, 0.0])),
    ...     ],
    ... )
    >>> frames.position("0", "b", observer="0").round(9).tolist()
    [3.0, 0.0, 0.0]
    >>> frames.position("a", "b", observer="a").round(9).tolist()
    [0.0, 2.0, 0.0]
    """

    def __init__(self, base: str, frames: Iterable[Frame]) -> None:
        self.base = base
        self._parents: dict[str, str] = {}
        self._seen_from_base = {base: Frame(base, base, IDENTITY, np.zeros(3, dtype=int))}
        for frame in frames:
            if frame.name in self._seen_from_base:
                raise ValueError(f"the label {frame.name!r} is used twice")
            parent = self._pose(frame.parent)
            # One step of eq. (18): R_0b = R_0a R_ab and r_0b = r_0a + R_0a r_ab.
            rotation = parent.rotation @ frame.rotation
            origin = parent.origin + times(parent.rotation, frame.origin)
            self._seen_from_base[frame.name] = Frame(frame.name, base, rotation, origin)
            self._parents[frame.name] = frame.parent

    @property
    def names(self) -> tuple[str, ...]:
        """The labels in the order in which the frames were given, the base first."""
        return tuple(self._seen_from_base)

    def rotation(self, a: str, b: str) -> Array:
        r"""Return :math:`R_{a,b} = R_{0,a}^T R_{0,b}` (eq. 1), shape (..., 3, 3).

        The matrix turns coordinates seen from frame b into coordinates seen from frame a.

        Examples
        --------
        >>> from qbound import Frame, Frames
        >>> from qbound.frames import axis_rotation
        >>> turned = Frame("1", "0", axis_rotation([0, 0, 1], np.pi / 2), np.zeros(3))
        >>> (Frames("0", [turned]).rotation("0", "1") @ [1, 0, 0]).round(9).tolist()
        [0.0, 1.0, 0.0]
        """
        return self._pose(a).rotation.mT @ self._pose(b).rotation

    def position(self, a: str, b: str, observer: str) -> Array:
        r"""Return :math:`r_{a,b}^{(c)} = R_{0,c}^T (r_{0,b} - r_{0,a})` (eq. 3), shape (..., 3).

        This is the vector from the origin of a to the origin of b, seen from the observer c. A
        vector that is seen from another frame has the same length and other coordinates.

        Examples
        --------
        Frame a is turned by a quarter about y, so the base's x axis is its z axis:

        >>> from qbound import Frame, Frames
        >>> from qbound.frames import axis_rotation
        >>> turned = Frame("a", "0", axis_rotation([0, 1, 0], np.pi / 2), np.array([5.0, 0.0, 0.0]))
        >>> frames = Frames("0", [turned])
        >>> frames.position("0", "a", observer="0").tolist()
        [5.0, 0.0, 0.0]
        >>> frames.position("0", "a", observer="a").round(9).tolist()
        [0.0, 0.0, 5.0]
        """
        seen_from_base = self._pose(b).origin - self._pose(a).origin
        return times(self._pose(observer).rotation.mT, seen_from_base)

    def frame(self, a: str, b: str) -> Array:
        r"""Return :math:`o_{a,b} = [R_{a,b}\ r_{a,b}^{(a)}]`, shape (..., 3, 4) (eqs. 1, 2).

        Examples
        --------
        >>> from qbound import Frames
        >>> Frames("0", []).frame("0", "0").tolist()
        [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
        """
        rotation, origin = self.rotation(a, b), self.position(a, b, a)
        # A frame that no joint moves has no leading axes, although the other one may have some.
        batch = np.broadcast_shapes(rotation.shape[:-2], origin.shape[:-1])
        rotation = np.broadcast_to(rotation, (*batch, 3, 3))
        origin = np.broadcast_to(origin, (*batch, 3))
        return np.concatenate([rotation, origin[..., None]], axis=-1)

    def unit_vector(self, a: str, b: str, observer: str) -> Array:
        r"""Return :math:`u_{a,b} = r_{a,b} / \|r_{a,b}\|` seen from an observer (eq. 8).

        Returns
        -------
        ndarray, shape (..., 3)

        Raises
        ------
        ValueError
            If the two origins coincide.

        Examples
        --------
        >>> from qbound import Frame, Frames
        >>> frames = Frames("0", [Frame("1", "0", np.eye(3), np.array([3.0, 0.0, 4.0]))])
        >>> frames.unit_vector("0", "1", observer="0").tolist()
        [0.6, 0.0, 0.8]
        """
        vector = self.position(a, b, observer)
        squared = np.asarray((vector * vector).sum(axis=-1), dtype=vector.dtype)
        if np.any(squared == 0):
            raise ValueError(f"the origins of {a!r} and {b!r} coincide: no direction (eq. 8)")
        return np.asarray(vector / square_root(squared)[..., None])

    def precedes(self, a: str, b: str) -> bool:
        """Tell whether a precedes b in the chain (eq. 5): a is the parent of b, or of its parents.

        A frame does not precede itself.

        Examples
        --------
        >>> from qbound import Frame, Frames
        >>> frames = Frames("0", [Frame("1", "0", np.eye(3), np.zeros(3))])
        >>> frames.precedes("0", "1"), frames.precedes("1", "0")
        (True, False)
        """
        for label in (a, b):
            self._pose(label)  # an unknown label is refused
        while b != self.base:
            b = self._parents[b]
            if b == a:
                return True
        return False

    def _pose(self, name: str) -> Frame:
        """Return a frame as it is seen from the base."""
        if name not in self._seen_from_base:
            raise ValueError(f"no frame {name!r}; the frames are {', '.join(self.names)}")
        return self._seen_from_base[name]


def axis_rotation(axis: ArrayLike, angle: Any) -> Array:
    r"""Return the rotation about a unit axis k, shape (..., 3, 3), by Rodrigues' formula.

    .. math:: R = k k^T + \cos q\,(I - k k^T) + \sin q\,[k]_\times

    The matrix :math:`[k]_\times` takes u to the cross product :math:`k \times u`. About y the
    rotation is the paper's :math:`R_y(q)` (Table 2).

    Parameters
    ----------
    axis : array_like, shape (3,)
        Unit vector.
    angle : array_like, shape (...)
        rad, or symbols.

    Examples
    --------
    >>> from qbound.frames import axis_rotation
    >>> (axis_rotation([0, 1, 0], np.pi / 2) @ [0, 0, 1]).round(9).tolist()
    [1.0, 0.0, 0.0]
    """
    k = np.asarray(axis)
    along = np.outer(k, k)  # keeps the part of a vector along the axis
    cosine, sine = (x[..., None, None] for x in cos_sin(angle))
    return np.asarray(along + cosine * (IDENTITY - along) + sine * cross_matrix(k))


def roll_pitch_yaw(roll: Any, pitch: Any, yaw: Any) -> Array:
    r"""Return :math:`R_z(yaw)\,R_y(pitch)\,R_x(roll)`, shape (..., 3, 3); angles in rad.

    Such a rotation can be the `mount` of a joint. The paper needs none.

    Examples
    --------
    >>> from qbound.frames import roll_pitch_yaw
    >>> (roll_pitch_yaw(0, 0, np.pi / 2) @ [1, 0, 0]).round(9).tolist()
    [0.0, 1.0, 0.0]
    """
    i, j, k = IDENTITY
    return axis_rotation(k, yaw) @ axis_rotation(j, pitch) @ axis_rotation(i, roll)
