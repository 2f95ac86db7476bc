"""What is a record? A dataclass that costs a tenth to define: nothing is compiled for a class.

To whoever reads, checks or uses the code `dataclass` is that of the standard library: fields,
`replace`, signatures, frozen instances, equality and hashes are the same. That one compiles up to
seven functions a class; here all classes share them. Fifty are defined before a command can answer.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError
from itertools import repeat
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

if TYPE_CHECKING:
    from inspect import Signature

__all__ = ["dataclass", "record"]

Class = TypeVar("Class")
Fields = tuple[Field[Any], ...]


def record(*, frozen: bool = False, eq: bool = True) -> Callable[[type[Class]], type[Class]]:
    """Return a decorator as `dataclasses.dataclass` does; it has no other options.

    Of a field there are the default and its factory.

    Examples
    --------
    >>> @record(frozen=True)
    ... class Place:
    ...     x: float
    ...     z: float = 0.0
    >>> Place(1.0), dataclasses.replace(Place(1.0), z=2.0) == Place(1.0, 2.0)
    (Place(x=1.0, z=0.0), True)
    >>> Place()
    Traceback (most recent call last):
    TypeError: Place: missing a required argument: 'x'
    """

    def decorated(cls: type[Class]) -> type[Class]:
        has_own_repr = "__repr__" in vars(cls)
        inherits = any(dataclasses.is_dataclass(base) for base in cls.__bases__)
        made: Any = dataclasses.dataclass(
            init=False, repr=False, eq=False, frozen=frozen and inherits
        )(cls)
        fields: Fields = dataclasses.fields(made)
        made.__init__ = _initialiser(made, fields)
        made.__signature__ = _LateSignature()
        if not has_own_repr:
            made.__repr__ = _shown
        if frozen:
            made.__setattr__, made.__delattr__ = _refuse_assignment, _refuse_deletion
            made.__dataclass_params__.frozen = True  # dataclasses that inherit ask for it
        if eq:
            values = attrgetter(*(field.name for field in fields))
            made.__eq__ = _equality(values)
            made.__hash__ = _hash(values) if frozen else None
        return cls

    return decorated


def _initialiser(cls: type, fields: Fields) -> Callable[..., None]:
    """Return the `__init__` of some fields."""
    names = tuple(field.name for field in fields)
    count, has_more = len(names), hasattr(cls, "__post_init__")
    keep = object.__setattr__  # not by `__dict__`, which would make every attribute slower to read

    def __init__(self: Any, /, *values: Any, **named: Any) -> None:
        if named or len(values) != count:
            values = _completed(cls, fields, values, named)
        any(map(keep, repeat(self), names, values))  # a loop: each gives None
        if has_more:
            self.__post_init__()

    return __init__


def _completed(
    cls: type, fields: Fields, values: tuple[Any, ...], named: dict[str, Any]
) -> tuple[Any, ...]:
    """Return the values of all fields: those in their order, those by name, and defaults."""
    found, used = list(values), 0
    for field in fields[len(values) :]:
        if field.name in named:
            found.append(named[field.name])
            used += 1
        elif field.default is not MISSING:
            found.append(field.default)
        elif field.default_factory is not MISSING:
            found.append(field.default_factory())
    if used != len(named) or len(found) != len(fields):  # `inspect` finds out what is wrong
        try:
            _signature(cls).bind(*values, **named)
        except TypeError as error:
            raise TypeError(f"{cls.__qualname__}: {error}") from None
    return tuple(found)


class _LateSignature:
    """The signature of a class, made where it is asked for: documents and errors do."""

    def __get__(self, instance: object, owner: type) -> Signature:
        """Make it, of the class alone: an instance that is called has another one."""
        if instance is not None:
            raise AttributeError("__signature__")
        return _signature(owner)


def _signature(cls: type) -> Signature:
    from inspect import Parameter, Signature

    def default(field: Field[Any]) -> Any:
        if field.default_factory is not MISSING:
            return MADE
        return Parameter.empty if field.default is MISSING else field.default

    each: Fields = dataclasses.fields(cls)
    kind = Parameter.POSITIONAL_OR_KEYWORD
    return Signature(
        [Parameter(f.name, kind, default=default(f), annotation=f.type) for f in each],
        return_annotation=None,
    )


class _Made:
    def __repr__(self) -> str:
        return "<factory>"


MADE = _Made()
"""Stands in a signature for a default that is made anew for each instance."""


@recursive_repr()
def _shown(self: Any) -> str:
    values = (f"{f.name}={getattr(self, f.name)!r}" for f in dataclasses.fields(self))
    return f"{type(self).__qualname__}({', '.join(values)})"


def _refuse_assignment(_: Any, name: str, __: Any) -> NoReturn:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_deletion(_: Any, name: str) -> NoReturn:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _equality(values: attrgetter[Any]) -> Callable[[Any, Any], Any]:
    def equal(self: Any, other: Any) -> Any:
        return values(self) == values(other) if type(other) is type(self) else NotImplemented

    return equal


def _hash(values: attrgetter[Any]) -> Callable[[Any], int]:
    return lambda self: hash(values(self))


if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    dataclass = record
