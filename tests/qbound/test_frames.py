"""Vector labelling: eqs. (1)-(8) and (18), in numbers and in symbols."""

from math import pi

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from engine_support.oracles import ANGLES, AXES, VECTORS, homogeneous
from qbound.frames import Frame, Frames, axis_rotation, roll_pitch_yaw

EYE = np.eye(3)


@st.composite
def trees(draw: st.DrawFn) -> tuple[Frames, dict[str, np.ndarray]]:
    """Frames that grow from a base in any order, and their 4 x 4 matrices seen from the base."""
    matrices, frames = {"0": np.eye(4)}, []
    for i in range(1, draw(st.integers(2, 6))):
        parent = draw(st.sampled_from(sorted(matrices)))
        rotation = Rotation.from_euler("zyx", [draw(ANGLES) for _ in range(3)]).as_matrix()
        origin = np.array(draw(VECTORS))
        frames.append(Frame(str(i), parent, rotation, origin))
        matrices[str(i)] = matrices[parent] @ homogeneous(rotation, origin)
    return Frames("0", frames), matrices


def any_three(data: st.DataObject, frames: Frames) -> tuple[str, str, str]:
    label = st.sampled_from(frames.names)
    return data.draw(label), data.draw(label), data.draw(label)


@given(trees(), st.data())
def test_frame_is_the_relative_homogeneous_matrix(tree, data) -> None:
    """Eqs. (1), (2): o_{a,b} = [R r]; o_{a,a} = [I 0]."""
    frames, matrices = tree
    a, b, _ = any_three(data, frames)
    expected = np.linalg.inv(matrices[a]) @ matrices[b]
    assert frames.frame(a, b).shape == (3, 4)
    assert_allclose(frames.frame(a, b), expected[:3], atol=1e-11)
    assert_allclose(frames.frame(a, a), np.eye(3, 4), atol=1e-11)


@given(trees(), st.data())
def test_observer_turns_a_vector_and_nothing_else(tree, data) -> None:
    """Eq. (3): r^{(c)} = R_{c,a} r^{(a)}: the same arrow, other coordinates."""
    frames, _ = tree
    a, b, c = any_three(data, frames)
    seen_from_a, seen_from_c = frames.position(a, b, a), frames.position(a, b, c)
    assert_allclose(seen_from_c, frames.rotation(c, a) @ seen_from_a, atol=1e-11)
    assert_allclose(np.linalg.norm(seen_from_c), np.linalg.norm(seen_from_a), atol=1e-11)


@given(trees(), st.data())
def test_position_is_a_difference_of_origins(tree, data) -> None:
    """Eqs. (3), (19): seen from the base, r_{a,b} is where b is, less where a is."""
    frames, matrices = tree
    a, b, c = any_three(data, frames)
    expected = (matrices[b] - matrices[a])[:3, 3]
    assert_allclose(frames.position(a, b, "0"), expected, atol=1e-11)
    assert_array_equal(frames.position(a, b, c), -frames.position(b, a, c))


@given(trees(), st.data())
def test_a_frame_stands_at_its_own_origin(tree, data) -> None:
    """Eq. (4), for every observer."""
    frames, _ = tree
    a, _, c = any_three(data, frames)
    assert_array_equal(frames.position(a, a, c), np.zeros(3))


@given(trees(), st.data())
def test_precedence_follows_the_parents(tree, data) -> None:
    """Eq. (5): transitive, never of itself or both ways, the base before all."""
    frames, _ = tree
    a, b, c = any_three(data, frames)
    assert not frames.precedes(a, a)
    assert not (frames.precedes(a, b) and frames.precedes(b, a))
    if frames.precedes(a, b) and frames.precedes(b, c):
        assert frames.precedes(a, c)
    assert frames.precedes("0", a) == (a != "0")


def test_precedence_of_a_branched_tree() -> None:
    """0 < 1 < 2 and 0 < 3: the branches do not precede each other."""
    frames = Frames(
        "0", [Frame(n, p, EYE, EYE[0]) for n, p in [("1", "0"), ("2", "1"), ("3", "0")]]
    )
    pairs = {(a, b) for a in frames.names for b in frames.names if frames.precedes(a, b)}
    assert pairs == {("0", "1"), ("0", "2"), ("0", "3"), ("1", "2")}
    assert frames.names == ("0", "1", "2", "3")


@given(trees(), st.data())
def test_columns_of_a_rotation_are_the_unit_vectors(tree, data) -> None:
    """Eqs. (6), (7): i_b, j_b, k_b seen from a, and [1 0 0], [0 1 0], [0 0 1] seen from b."""
    frames, matrices = tree
    a, b, _ = any_three(data, frames)
    axes_of_b = np.linalg.inv(matrices[a])[:3, :3] @ matrices[b][:3, :3]
    assert_allclose(frames.rotation(a, b), axes_of_b, atol=1e-12)
    assert_allclose(frames.rotation(b, b), EYE, atol=1e-12)
    assert np.linalg.det(frames.rotation(a, b)) == pytest.approx(1)


@given(trees(), st.data())
def test_unit_vector_is_the_direction(tree, data) -> None:
    """Eq. (8): length one, the same direction, for every observer; coinciding origins refused."""
    frames, _ = tree
    a, b, c = any_three(data, frames)
    vector = frames.position(a, b, c)
    if not vector.any():
        with pytest.raises(ValueError, match="coincide"):
            frames.unit_vector(a, b, c)
        return
    assert_allclose(frames.unit_vector(a, b, c) * np.linalg.norm(vector), vector, atol=1e-11)
    assert np.linalg.norm(frames.unit_vector(a, b, c)) == pytest.approx(1)


def test_unit_vector_refuses_one_coinciding_pair_among_many() -> None:
    frames = Frames("0", [Frame("1", "0", EYE, np.array([[1.0, 0, 0], [0, 0, 0]]))])
    with pytest.raises(ValueError, match="'0' and '1' coincide"):
        frames.unit_vector("0", "1", "0")


def test_leading_axes_are_many_frames_at_once() -> None:
    q = np.linspace(-3, 3, 7).reshape(7, 1) + np.arange(2)

    def tree(x: np.ndarray) -> Frames:
        one = Frame("1", "0", axis_rotation((0, 1, 0), x), np.array([1.0, 2, 3]))
        return Frames(
            "0", [one, Frame("2", "1", axis_rotation((1, 0, 0), x), np.array([3.0, 1, 0]))]
        )

    many = tree(q)
    assert many.frame("1", "2").shape == (7, 2, 3, 4)
    for index in np.ndindex(q.shape):
        one = tree(q[index])
        assert_allclose(many.frame("0", "2")[index], one.frame("0", "2"), atol=1e-15)
        assert_allclose(many.unit_vector("0", "2", "1")[index], one.unit_vector("0", "2", "1"))


@given(AXES, ANGLES)
def test_axis_rotation_is_the_rotation_vector(axis, angle) -> None:
    k = np.array(axis) / np.linalg.norm(axis)
    assert_allclose(
        axis_rotation(k, angle), Rotation.from_rotvec(k * angle).as_matrix(), atol=1e-14
    )


def test_rotation_about_y_takes_z_to_x() -> None:
    """R_y of Table 2: the sign that eq. (29) rests on."""
    assert_allclose(axis_rotation((0, 1, 0), pi / 2) @ [0, 0, 1], [1, 0, 0], atol=1e-15)


@given(st.lists(ANGLES, min_size=3, max_size=3))
def test_roll_pitch_yaw_turns_about_fixed_axes(rpy) -> None:
    """URDF: Rz(yaw) Ry(pitch) Rx(roll)."""
    assert_allclose(roll_pitch_yaw(*rpy), Rotation.from_euler("xyz", rpy).as_matrix(), atol=1e-14)


def test_symbols_and_numbers_come_from_one_definition() -> None:
    """General rotations: two joints about oblique axes, a mount, symbolic offsets."""
    q = sympy.symbols("q1 q2", real=True)
    lengths = sympy.symbols("x y z", real=True)
    third = sympy.Rational(1, 3)
    axis = np.array([third, 2 * third, 2 * third], dtype=object)

    def tree(q, lengths, axis):
        origin = np.array(lengths)
        return Frames(
            "0",
            [
                Frame("1", "0", axis_rotation(axis, q[0]), origin),
                Frame(
                    "2", "1", roll_pitch_yaw(q[1], q[0], q[1]) @ axis_rotation(axis, q[1]), origin
                ),
            ],
        )

    symbolic = tree(q, lengths, axis)
    values = (0.7, -1.9, 1.5, -0.5, 2.25)
    numeric = tree(values[:2], values[2:], np.array([1, 2, 2]) / 3)
    for name in ("frame", "unit_vector"):
        arguments = ("1", "2", "0")[: 2 if name == "frame" else 3]
        expression = getattr(symbolic, name)(*arguments)
        substituted = sympy.lambdify([*q, *lengths], expression.tolist())(*values)
        assert_allclose(
            np.array(substituted, float), getattr(numeric, name)(*arguments), atol=1e-14
        )


def test_symbolic_rotations_are_orthogonal_by_identity() -> None:
    q = sympy.symbols("q1:4", real=True)
    r = sympy.Matrix(roll_pitch_yaw(*q))
    assert (r.T * r).applyfunc(sympy.simplify) == sympy.eye(3)
    assert sympy.simplify(r.det()) == 1


def test_symbolic_unit_vector_is_exact() -> None:
    frames = Frames("0", [Frame("1", "0", EYE.astype(int), np.array([1, 1, 0], dtype=object))])
    assert frames.unit_vector("0", "1", "0")[0] == 1 / sympy.sqrt(2)


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        ([Frame("1", "0", EYE, EYE[0]), Frame("1", "0", EYE, EYE[0])], "'1' is used twice"),
        ([Frame("0", "0", EYE, EYE[0])], "'0' is used twice"),
        ([Frame("2", "1", EYE, EYE[0])], "no frame '1'; the frames are 0"),
    ],
    ids=["label twice", "label of the base", "parent unknown"],
)
def test_frames_refuse(frames, message) -> None:
    with pytest.raises(ValueError, match=message):
        Frames("0", frames)


@pytest.mark.parametrize(
    "ask",
    [
        lambda f: f.rotation("0", "9"),
        lambda f: f.position("0", "1", "9"),
        lambda f: f.unit_vector("9", "1", "0"),
        lambda f: f.precedes("9", "1"),
        lambda f: f.precedes("1", "9"),
    ],
    ids=["rotation", "observer", "unit vector", "precedes", "is preceded"],
)
def test_an_unknown_label_is_refused_by_name(ask) -> None:
    frames = Frames("0", [Frame("1", "0", EYE, EYE[0])])
    with pytest.raises(ValueError, match="no frame '9'; the frames are 0, 1"):
        ask(frames)
