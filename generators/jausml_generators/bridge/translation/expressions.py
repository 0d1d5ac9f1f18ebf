"""Typed expressions of translations: a closed set, which printers print in a language.

Each has the kind of value that it yields. What is refused or counted while a value is computed is a
`Limit`, a `LookUp` or a conversion; all else is total.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from jausml.language.attributes import expressions as authored
from jausml_generators.bridge.translation.places import Condition, MarkerOperand, Place

REAL, INTEGER, BOOLEAN, TEXT, OCTETS = "real", "integer", "boolean", "text", "octets"
BITS, LIST, FORMAT, OTHER = "bits", "list", "format", "other"
QUATERNION, TIME = "quaternion", "time"


Scalar: TypeAlias = float | int | bool | str | bytes


@dataclass(frozen=True)
class Constant:
    """A value of the model."""

    value: Scalar
    kind: str


def number(value: float) -> Constant:
    """Returns a number as a constant of its kind."""
    return Constant(value, INTEGER if isinstance(value, int) else REAL)


@dataclass(frozen=True)
class Read:
    """The value at a place."""

    place: Place
    kind: str = OTHER


@dataclass(frozen=True)
class Setting:
    """An attribute of the bridge that may change: a quantity, a frame, what was kept."""

    name: str
    kind: str = REAL


@dataclass(frozen=True)
class Negative:
    """The opposite of a number."""

    value: Expression
    kind: str = REAL


@dataclass(frozen=True)
class Now:
    """The present time."""

    kind: str = TIME


@dataclass(frozen=True)
class Cast:
    """A value as one of another kind: integers as reals, numbers as truths, arrays as octets."""

    value: Expression
    kind: str


@dataclass(frozen=True)
class Length:
    """The number of elements of a list, or of names in a constant."""

    of: Place
    kind: str = INTEGER


_MARKER_KINDS = {"float32": REAL, "float64": REAL, "bool": BOOLEAN}
# Types of more digits than a double has.
_LARGE = frozenset({"int64", "uint64"})


def marker_value(operand: MarkerOperand) -> Read | Cast | Length:
    """Returns the value of a number that a marker asks for."""
    if not operand.type:
        return Length(operand.place)
    read = Read(operand.place, _MARKER_KINDS.get(operand.type, INTEGER))
    # Reals cannot tell large integers apart, in whatever language.
    return Cast(read, REAL) if operand.type in _LARGE else read


@dataclass(frozen=True)
class Convert:
    """The result of a conversion of the catalogue, or its results.

    What it computes stands in `CONVERSIONS`, by its name.

    Attributes:
        near: The instant near which a time is meant; None where it is not asked.
    """

    name: str
    inputs: tuple[Expression, ...]
    arguments: tuple[Expression, ...] = ()
    near: Expression | None = None
    kind: str = REAL


@dataclass(frozen=True)
class LookUp:
    """The counterpart of a key in a table, which is a constant of the module."""

    key: Expression
    table: str
    kind: str


@dataclass(frozen=True)
class Limit:
    """A value limited to its target; others are counted, cut off or refused.

    Attributes:
        policy: What becomes of values that do not fit: `clamp`, `drop_field`, `drop_message` or
            `error`.
        how: What keeps them within: empty for two numbers, else `integer`, `listed`, `single`,
            `finite`, `text`, `octets`, `sized`, or `within` for what a map limits on purpose.
        bounds: What it must keep to.
    """

    owner: str
    policy: str
    how: str
    path: str
    value: Expression
    bounds: tuple[Expression, ...] = ()

    @property
    def kind(self) -> str:
        """Kind of the value."""
        return INTEGER if self.how in {"integer", "listed"} else self.value.kind

    @property
    def drops_field(self) -> bool:
        """Whether there is no value where it does not fit."""
        return self.policy == "drop_field"


@dataclass(frozen=True)
class Ranges:
    """Legal ranges of integers, as a bound of a limit."""

    ranges: tuple[tuple[int, int], ...]
    kind: str = OTHER


@dataclass(frozen=True)
class Operand:
    """The value of a name in an authored expression."""

    value: Expression
    hint: str
    is_computed: bool


@dataclass(frozen=True)
class Authored:
    """The value of an expression of the model."""

    expression: authored.Expression
    operands: tuple[tuple[str, Operand], ...]
    kind: str = REAL


@dataclass(frozen=True)
class UserCall:
    """The result, or results, of a conversion that the user writes."""

    method: str
    inputs: tuple[Expression, ...]
    kind: str = OTHER


@dataclass(frozen=True)
class Either:
    """A value where conditions hold, and another one where they do not."""

    conditions: tuple[Condition, ...]
    value: Expression
    otherwise: Expression

    @property
    def kind(self) -> str:
        """Kind of both values."""
        return self.value.kind


@dataclass(frozen=True)
class New:
    """A new object of a class: an element or container without values, or one made of parts.

    Attributes:
        is_spread: Whether the only part is a tuple of the parts.
    """

    class_name: str
    parts: tuple[Expression, ...] = ()
    is_spread: bool = False
    kind: str = OTHER


@dataclass(frozen=True)
class NewList:
    """A new list, without elements unless it says how many of what."""

    element: Constant | New | None = None
    count: int = 0
    kind: str = LIST


@dataclass(frozen=True)
class IfKept:
    """The result for a value in a variable; none where a limit dropped the value."""

    kept: Read
    made: Expression

    @property
    def kind(self) -> str:
        """Kind of what is made."""
        return self.made.kind


@dataclass(frozen=True)
class Translate:
    """A message inside a message, translated by the method of another map."""

    method: str
    message: Expression
    kind: str = OTHER


@dataclass(frozen=True)
class Decode:
    """The JAUS message of a class in octets."""

    class_name: str
    data: Expression
    kind: str = OTHER


@dataclass(frozen=True)
class Encode:
    """The octets of a JAUS message."""

    message: Expression
    kind: str = OCTETS


@dataclass(frozen=True)
class ByName:
    """The elements of a list in the order of constant names; none for a name that is missing.

    Attributes:
        needed: The list of which no element may be missing, to be told; empty where some may.
        owner: Attribute of the bridge that is the connection, which may know them by messages
            before; empty where they are of this message alone.
    """

    names: str
    keys: Expression
    items: Expression
    needed: str = ""
    owner: str = ""
    kind: str = LIST


@dataclass(frozen=True)
class FirstOf:
    """As many of the first elements of a list as there are constant names."""

    items: Expression
    names: str
    kind: str = LIST


@dataclass(frozen=True)
class NamesOf:
    """The first of constant names, as many as a list has elements."""

    names: str
    items: Place
    kind: str = field(default=LIST)


Expression: TypeAlias = (
    Constant
    | Read
    | Setting
    | Negative
    | Now
    | Cast
    | Length
    | Convert
    | LookUp
    | Limit
    | Ranges
    | Authored
    | UserCall
    | Either
    | New
    | NewList
    | IfKept
    | Translate
    | Decode
    | Encode
    | ByName
    | FirstOf
    | NamesOf
)
