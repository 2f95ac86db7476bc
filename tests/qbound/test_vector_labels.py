"""Section 2, eqs. (1)-(8) and (18): frames and vectors, in numbers and in symbols."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from qbound.frames import Frame, Frames, axis_rotation, roll_pitch_yaw
from support.chains import ANGLES, DIRECTIONS, ROTATIONS, VECTORS, matrix


@st.composite
def trees(draw):
    """Frames that grow from a base in any order, and their 4 x 4 matrices seen from the base."""
    matrices, frames = {"0": np.eye(4)}, []
    for i in range(1, draw(st.integers(2, 6))):
        parent = draw(st.sampled_from(sorted(matrices)))
        rotation, origin = draw(ROTATIONS), draw(VECTORS)
        frames.append(Frame(str(i), parent, rotation, origin))
        matrices[str(i)] = matrices[parent] @ matrix(rotation, origin)
    return Frames("0", frames), matrices


def any_three(data, frames):
    label = st.sampled_from(frames.names)
    return data.draw(label), data.draw(label), data.draw(label)


@given(trees(), st.data())
def test_a_frame_is_the_relative_homogeneous_matrix(tree, data):
    frames, matrices = tree
    a, b, _ = any_three(data, frames)
    expected = np.linalg.inv(matrices[a]) @ matrices[b]
    assert_allclose(frames.frame(a, b), expected[:3], atol=1e-11)  # eq. (1)
    assert_allclose(frames.frame(a, a), np.eye(3, 4), atol=1e-11)  # eq. (2)


@given(trees(), st.data())
def test_an_observer_turns_a_vector_and_nothing_else(tree, data):
    frames, _ = tree
    a, b, c = any_three(data, frames)
    seen_from_a, seen_from_c = frames.position(a, b, a), frames.position(a, b, c)
    assert_allclose(seen_from_c, frames.rotation(c, a) @ seen_from_a, atol=1e-11)
    assert_allclose(frames.position(a, a, c), 0, atol=1e-15)  # eq. (4)


@given(trees(), st.data())
def test_the_unit_vector_is_the_direction(tree, data):
    frames, _ = tree
    a, b, c = any_three(data, frames)
    vector = frames.position(a, b, c)
    length = np.linalg.norm(vector)
    if length > 1e-6:
        assert_allclose(length * frames.unit_vector(a, b, c), vector, atol=1e-11)  # eq. (8)


@given(DIRECTIONS, ANGLES)
def test_axis_rotation_is_the_rotation_vector(direction, angle):
    axis = direction / np.linalg.norm(direction)
    expected = Rotation.from_rotvec(angle * axis).as_matrix()
    assert_allclose(axis_rotation(axis, angle), expected, atol=1e-14)


@given(ANGLES, ANGLES, ANGLES)
def test_roll_pitch_yaw_turns_about_fixed_axes(roll, pitch, yaw):
    expected = Rotation.from_euler("xyz", [roll, pitch, yaw]).as_matrix()
    assert_allclose(roll_pitch_yaw(roll, pitch, yaw), expected, atol=1e-14)


def test_precedence_follows_the_parents():
    pairs = [("1", "0"), ("2", "1"), ("side", "1")]
    frames = Frames("0", [Frame(b, a, np.eye(3), np.ones(3)) for b, a in pairs])
    before = {(a, b) for a in frames.names for b in frames.names if frames.precedes(a, b)}
    assert before == {("0", "1"), ("0", "2"), ("0", "side"), ("1", "2"), ("1", "side")}


def test_symbols_and_numbers_come_from_one_definition():
    q, x, z = sp.symbols("q x z", real=True)
    turn = axis_rotation([0, 1, 0], q)
    assert sp.simplify(sp.Matrix(turn.T @ turn)) == sp.eye(3)
    assert sp.Matrix(turn) == sp.Matrix(
        [[sp.cos(q), 0, sp.sin(q)], [0, 1, 0], [-sp.sin(q), 0, sp.cos(q)]]
    )
    frames = Frames("0", [Frame("1", "0", turn, np.array([x, 0, z], dtype=object))])
    assert frames.position("0", "1", "0").tolist() == [x, 0, z]
    assert frames.unit_vector("0", "1", "0")[0] == x / sp.sqrt(x**2 + z**2)


def test_leading_axes_are_many_frames_at_once():
    angles = np.linspace(0, 1, 5)
    origin = np.array([1.0, 2.0, 3.0])
    frames = Frames("0", [Frame("1", "0", axis_rotation([0, 1, 0], angles), origin)])
    assert frames.frame("0", "1").shape == (5, 3, 4)
    for k, angle in enumerate(angles):
        alone = Frames("0", [Frame("1", "0", axis_rotation([0, 1, 0], angle), origin)])
        assert_allclose(frames.position("1", "0", "1")[k], alone.position("1", "0", "1"))


def test_wrong_labels_are_refused():
    still = np.eye(3), np.zeros(3)
    with pytest.raises(ValueError, match="'1' is used twice"):
        Frames("0", [Frame("1", "0", *still), Frame("1", "0", *still)])
    with pytest.raises(ValueError, match="no frame 'x'; the frames are 0"):
        Frames("0", [Frame("1", "x", *still)])
    frames = Frames("0", [Frame("1", "0", *still)])
    with pytest.raises(ValueError, match="no frame '2'; the frames are 0, 1"):
        frames.position("0", "2", "0")
    with pytest.raises(ValueError, match="'0' and '1' coincide"):
        frames.unit_vector("0", "1", "0")
