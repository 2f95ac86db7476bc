"""A record is what `dataclasses.dataclass` makes of the same class, but for what it compiles."""

import copy
import dataclasses
import inspect
import pickle
from functools import cached_property
from typing import Any, ClassVar

import pytest

from qbound.model.robot import Pair, Revolute, Robot
from qbound.records import record


def place(decorator: Any, **options: Any) -> Any:
    @decorator(**options)
    class Place:
        """Somewhere."""

        kind: ClassVar[str] = "place"
        x: float
        z: float = 0.5
        names: list[str] = dataclasses.field(default_factory=list)

        def __post_init__(self) -> None:
            if self.x < 0:
                raise ValueError("x is negative")

        @cached_property
        def double(self) -> float:
            return 2 * self.x

    return Place


OPTIONS = [{}, {"eq": False}, {"frozen": True}, {"frozen": True, "eq": False}]
both = pytest.mark.parametrize("options", OPTIONS, ids=str)


@both
def test_fields_signature_and_text_are_the_same(options) -> None:
    ours, theirs = (place(decorator, **options) for decorator in (record, dataclasses.dataclass))
    assert [f.name for f in dataclasses.fields(ours)] == ["x", "z", "names"]
    one, other = (inspect.signature(cls) for cls in (ours, theirs))
    assert str(one) == str(other)
    assert repr(ours(1.0, names=["a"])) == repr(theirs(1.0, names=["a"]))
    assert ours.__match_args__ == theirs.__match_args__
    assert (ours(1.0) == ours(1.0)) == (theirs(1.0) == theirs(1.0))
    assert (ours.__hash__ is None) == (theirs.__hash__ is None)
    assert ours.__dataclass_params__.frozen == theirs.__dataclass_params__.frozen


@both
def test_values_come_in_their_order_by_name_or_by_default(options) -> None:
    cls = place(record, **options)
    for found in (
        cls(1.0, 0.5, []),
        cls(z=0.5, x=1.0),
        cls(1.0),
        dataclasses.replace(cls(3.0), x=1),
    ):
        assert (found.x, found.z, found.names, found.double) == (1.0, 0.5, [], 2.0)
    assert cls(1.0).names is not cls(1.0).names
    assert copy.deepcopy(cls(1.0)).x == 1.0
    with pytest.raises(ValueError, match="negative"):
        cls(-1.0)


@pytest.mark.parametrize(
    ("values", "named", "says"),
    [
        ((), {}, "missing a required argument: 'x'"),
        ((1.0, 2.0, [], 4.0), {}, "too many"),
        ((1.0,), {"x": 2.0}, "multiple values for argument 'x'"),
        ((1.0,), {"w": 2.0}, "unexpected keyword argument 'w'"),
        ((1.0, 2.0, []), {"w": 2.0}, "unexpected keyword argument 'w'"),
    ],
)
def test_wrong_arguments_are_refused_by_name(values, named, says) -> None:
    with pytest.raises(TypeError, match=f"Place: .*{says}"):
        place(record)(*values, **named)


def test_what_is_frozen_is_changed_by_nobody_and_hashed_by_its_values() -> None:
    place_of = place(record, frozen=True)
    one = place_of(1.0, 2.0, ())
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field 'x'"):
        one.x = 2.0
    with pytest.raises(dataclasses.FrozenInstanceError, match="cannot delete field 'x'"):
        del one.x
    assert hash(one) == hash(place_of(1.0, 2.0, ()))
    assert one != place_of(1.0, 3.0, ())
    assert one != (1.0, 2.0, ())
    changing = place(record)(1.0)
    changing.x = 2.0
    assert changing.x == 2.0


@pytest.mark.parametrize("decorator", [record, dataclasses.dataclass])
def test_records_and_dataclasses_inherit_from_each_other(decorator) -> None:
    for base in (record, dataclasses.dataclass):

        @decorator(frozen=True)
        class Named(place(base, frozen=True)):
            name: str = "a"

        found = Named(1.0, name="b")
        assert (found.x, found.z, found.name) == (1.0, 0.5, "b")
        with pytest.raises(dataclasses.FrozenInstanceError):
            found.name = "c"


def test_the_classes_of_robots_are_records() -> None:
    assert Pair("B", ("1", "2")) == Pair("B", ("1", "2"), 0.0)
    assert pickle.loads(pickle.dumps(Pair("B", ("1", "2")))) == Pair("B", ("1", "2"))
    assert [*inspect.signature(Revolute).parameters][:3] == ["name", "parent", "frame"]
    assert "collisions: 'bool' = False" in str(inspect.signature(Robot))
