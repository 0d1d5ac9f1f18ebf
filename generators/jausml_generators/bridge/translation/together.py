"""Which lists are translated as a whole: all elements at once, in columns of numbers.

A translation that treats each element alike is printed as a function, which is called once for all
elements. Where one looks at the value of an element, such as a text or the choice of a variant, it
is a loop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from jausml.language.attributes.expressions import FUNCTIONS, operations
from jausml.language.cdr import PRIMITIVES, fields_of
from jausml.language.metamodel.classes import ros
from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.definition import Definition
from jausml.language.semantics.conversions.orientations import (
    EnuQuaternionToNedAngles,
    EnuYawToNedHeading,
    FluQuaternionToFrdAngles,
    FrdAnglesToFluQuaternion,
    NedAnglesToEnuQuaternion,
    NedHeadingToEnuYaw,
    WrapAngle,
)
from jausml.language.semantics.conversions.times import TimestampToTime, TimeToTimestamp
from jausml_generators.bridge.translation import expressions as values
from jausml_generators.bridge.translation.places import (
    HasValue,
    Local,
    Place,
    RosStart,
    There,
)
from jausml_generators.bridge.translation.steps import Alike, Choose, Each, Let, Require, Write
from jausml_generators.python.codec.classes import ContainerClass
from jausml_generators.python.codec.jaus_fields import JausStart
from jausml_generators.python.codec.members import PartValue
from jausml_generators.python.codec.scalars import Fixed

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.attributes import expressions as authored
    from jausml_generators.bridge.translation.expressions import Expression
    from jausml_generators.bridge.translation.places import Condition
    from jausml_generators.bridge.translation.steps import Step

Start: TypeAlias = JausStart | RosStart
TypeName: TypeAlias = Callable[[ros.MessageType], str]

COLUMNS = frozenset(
    each.name
    for each in (
        EnuQuaternionToNedAngles,
        EnuYawToNedHeading,
        FluQuaternionToFrdAngles,
        FrdAnglesToFluQuaternion,
        NedAnglesToEnuQuaternion,
        NedHeadingToEnuYaw,
        TimeToTimestamp,
        TimestampToTime,
        WrapAngle,
    )
)
"""Conversions of which `jausml_runtime.columns` has a form for columns."""

_LIMITS = frozenset({"", "finite", "integer", "listed", "single", "within"})
_NUMBERS = frozenset({values.REAL, values.INTEGER, values.BITS, values.QUATERNION, values.TIME})
_OCTETS = frozenset("bB")
_REALS = frozenset("fd")
_NO_COLUMNS = frozenset("?Q")


# ------------------------------------------------------------------ the ends


def alike(source: Start, target: Start, type_name: TypeName) -> Alike | None:
    """Returns how the elements of two lists lie, if all lie alike in each."""
    if not (_lies_alike(source) and _lies_alike(target)):
        return None
    taken, made = _python_type(source, type_name), _python_type(target, type_name)
    are_octets = all(_only_code(each) in _OCTETS for each in (source, target))
    return Alike(taken, made, _code(target), are_octets=are_octets)


def _lies_alike(start: Start) -> bool:
    """Whether the elements of a list have their numbers at the same places."""
    if isinstance(start, JausStart):
        return isinstance(start.value, PartValue) and bool(start.value.part.row)
    return _code(start) != "" if start.type is None else _is_even(start.type)


def _is_even(message: ros.MessageType) -> bool:
    """Whether the size of a message depends on its texts alone."""
    for each in fields_of(message):
        is_number = each.primitive is not None and each.primitive.code != "?"
        is_message = each.message is not None and _is_even(each.message)
        if not each.is_single or not (is_number or is_message or each.text == "string"):
            return False
    return True


def _python_type(start: Start, type_name: TypeName) -> str:
    if isinstance(start, JausStart):
        return start.value.python_type if isinstance(start.value, PartValue) else ""
    if start.type is not None:
        return type_name(start.type)
    return "float" if _code(start) in _REALS else "int"


def _code(start: Start) -> str:
    """The format character of a number of ROS; empty for others."""
    if isinstance(start, JausStart) or not isinstance(start.field, ros.PrimitiveField):
        return ""
    primitive = PRIMITIVES.get(start.field.type.name)
    return "" if primitive is None or primitive.code in _NO_COLUMNS else primitive.code


def _only_code(start: Start) -> str:
    """The format character of the only number of an element; empty where there are more.

    Empty too where the number is not the one on the wire, as that of a scaled integer.
    """
    if not isinstance(start, JausStart):
        return _code(start)
    part = start.value.part if isinstance(start.value, PartValue) else None
    if not isinstance(part, ContainerClass) or part.presence_size or len(part.members) != 1:
        return ""
    (only,) = part.members
    value = only.value
    if not isinstance(value, Fixed) or value.scale is not None or value.offset:
        return ""
    return value.format


# ------------------------------------------------------------------ what is done with them


def octet_limit(step: Each) -> values.Limit | None:
    """Returns the limit of the only value of elements that are octets on both sides.

    It has a conversion of the octet alone; None where more is done.
    """
    alike = step.alike
    if alike is None or not alike.are_octets or len(step.steps) != 1:
        return None
    (only,) = step.steps
    if not isinstance(only, Write) or not isinstance(only.value, values.Limit):
        return None
    limit = only.value
    made = limit.value
    if limit.how != "integer" or limit.drops_field or not isinstance(made, values.Convert):
        return None
    (given,) = made.inputs if len(made.inputs) == 1 else (None,)
    while isinstance(given, values.Cast):
        given = given.value
    is_plain = isinstance(given, values.Read) and given.place.root == step.item
    return limit if is_plain and not made.arguments and made.near is None else None


def is_together(step: Each) -> bool:
    """Whether all elements of a list are translated alike, in columns."""
    if step.alike is None:
        return False
    of_items = _OfItems(step.item)
    return all(of_items.step(each) for each in step.steps)


class _OfItems:
    """Tells what may be said of all elements at once."""

    def __init__(self, item: Local) -> None:
        self._item = item

    def step(self, step: Step) -> bool:
        """Whether a step treats all elements alike."""
        match step:
            case Let(value=value):
                return self.value(value)
            case Write(value=value):
                return value.kind != values.LIST and self.value(value)
            case Require(condition=condition):
                return self._condition(condition)
            case Choose(conditions=alternatives, steps=steps):
                tests = all(self._condition(each) for group in alternatives for each in group)
                return tests and all(self.step(each) for each in steps)
        return False

    def value(self, value: Expression) -> bool:  # noqa: C901 - one for each kind
        """Whether an expression can be asked for columns."""
        match value:
            case values.Constant() | values.Setting() | values.Now() | values.Ranges():
                return True
            case values.Read(place=place, kind=kind):
                return not self._is_of_item(place) or self._is_number(place, kind)
            case values.Length(of=place):
                return not self._is_of_item(place)
            case values.Negative(value=inner):
                return self.value(inner)
            case values.Cast(value=inner, kind=kind):
                return kind == values.REAL and self.value(inner)
            case values.Convert(name=name, inputs=inputs, arguments=arguments):
                return _takes_columns(name) and self._all((*inputs, *arguments))
            case values.Limit(how=how, value=inner, bounds=bounds):
                return how in _LIMITS and self._all((inner, *bounds))
            case values.LookUp(key=key, kind=kind):
                return kind in {values.REAL, values.INTEGER} and self.value(key)
            case values.Authored(expression=expression, operands=operands):
                given = (operand.value for _, operand in operands)
                return is_arithmetic(expression) and self._all(given)
            case values.Either(conditions=conditions, value=inner, otherwise=otherwise):
                tests = all(self._condition(each) for each in conditions)
                return tests and self._all((inner, otherwise))
            case values.New(parts=parts, is_spread=is_spread):
                return (is_spread or not parts) and self._all(parts)
        return False

    def _all(self, found: Iterable[Expression]) -> bool:
        return all(map(self.value, found))

    def _is_of_item(self, place: Place) -> bool:
        return place.root == self._item

    @staticmethod
    def _is_number(place: Place, kind: str) -> bool:
        return kind in _NUMBERS and all(isinstance(each, str) for each in place.steps)

    def _condition(self, condition: Condition) -> bool:
        if isinstance(condition, HasValue):
            return isinstance(condition.place.root, str)
        return isinstance(condition, There) or not self._is_of_item(condition.place)


def _takes_columns(name: str) -> bool:
    definition = CONVERSIONS[name].definition
    return name in COLUMNS or (isinstance(definition, Definition) and definition.is_rational)


def is_arithmetic(expression: authored.Expression) -> bool:
    """Whether an expression is made of sums, products, comparisons and choices alone."""
    return operations(expression).isdisjoint({"/", "^", *FUNCTIONS})
