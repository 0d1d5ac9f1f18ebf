"""A conversion: inputs and outputs, and its effect on units and numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import zip_longest
from typing import Any, ClassVar

from jausml.language.attributes.expressions import EvaluationError
from jausml.language.attributes.intervals import (
    EMPTY,
    EVERYTHING,
    Interval,
    is_empty,
    product,
    total,
)
from jausml.language.semantics.conversions.definition import PARTS, Definition, NoArithmetic
from jausml.language.semantics.paths.attributes import BOOL, LIST, NUMBER, NUMBERS, TEXT, TIME_STAMP

FLU, FRD = "forwardLeftUp", "forwardRightDown"
ENU, NED = "eastNorthUp", "northEastDown"
UP, DOWN = "localUp", "localDown"

ANY = "any"
VALUE = "value"
RADIAN, DEGREE, PERCENT, ONE = "radian", "degree", "percent", "1"
TURN = (-math.pi, math.pi)
"""One turn, within which an angle is given."""

OWN = "same"
"""Stands for the unit of the quantity that a conversion refers to."""

_INSTANCES = {VALUE: (NUMBER, BOOL, TEXT), NUMBERS: (LIST,), NUMBER: (VALUE,)}


class NoValueError(ValueError):
    """An input that a conversion has no result for, or that it cuts off on purpose."""


class ArgumentKind(Enum):
    """Kinds of arguments of a conversion: a formula is a text that is an expression."""

    NUMBER = "number"
    TEXT = "text"
    FORMULA = "formula"
    METHOD = "method"
    TABLE = "table"


_REFERRED = {ArgumentKind.NUMBER: "bridge.Quantity", ArgumentKind.TABLE: "bridge.ValueTable"}


@dataclass(frozen=True, slots=True)
class Argument:
    """A parameter of a conversion; each is required."""

    name: str
    kind: ArgumentKind = ArgumentKind.NUMBER

    @property
    def feature(self) -> str:
        """The feature of `bridge.Conversion` that holds it."""
        return "arguments" if self.kind is ArgumentKind.NUMBER else self.name

    @property
    def refers_to(self) -> str:
        """The class of the elements that a name in its place refers to; empty for none."""
        return _REFERRED.get(self.kind, "")

    @property
    def is_text(self) -> bool:
        """Whether it is written in quotes."""
        return self.kind in (ArgumentKind.TEXT, ArgumentKind.FORMULA)


MAXIMUM = Argument("maximum")
"""The measure or the limit of values: a number above zero."""


class UnitEffect(Enum):
    """Effects on the unit of a number, of conversions that are not from one unit to another."""

    SAME = "same"
    ANY = "any"
    SQUARE = "square"
    ROOT = "root"
    STATED = "stated"


class Effect(Enum):
    """Effects of a conversion on a number: how its sign, digits and meaning follow from it.

    `SAME` is the number itself, where nothing is cut off and apart from whole turns; `LINEAR` is
    it times a factor, perhaps with an offset.
    """

    SAME = "same"
    NEGATED = "negated"
    LINEAR = "linear"
    OTHER = "other"


_SIGNS = {Effect.SAME: 1, Effect.LINEAR: 1, Effect.NEGATED: -1}


class Conversion:
    """The meaning of one literal of `bridge.ConversionKind`.

    The runtime has a function of the same name, which bridges call; here stands what the toolchain
    knows of it. `forward` evaluates the definition, so that generated tests compare two
    computations.

    Attributes:
        inputs: Kinds of the values that it takes; a `+` behind one stands for one or more.
        units: What becomes of the unit, or the units that it takes and yields.
        frames: Frames that it takes and yields, empty when it has nothing to do with frames.
        takes_axes: Axes of what a conversion between frames takes; empty text for an orientation.
        limits: Ranges of the results when they do not depend on the inputs, else empty.
        knows_unknown: Whether it makes a value of what a marker says, as of an unknown occupancy.
    """

    name: ClassVar[str]
    definition: ClassVar[Definition | NoArithmetic]
    inputs: ClassVar[tuple[str, ...]] = (NUMBER,)
    outputs: ClassVar[tuple[str, ...]] = (NUMBER,)
    arguments: ClassVar[tuple[Argument, ...]] = ()
    units: ClassVar[UnitEffect | tuple[str, str]] = UnitEffect.ANY
    frames: ClassVar[tuple[str, ...]] = ()
    takes_axes: ClassVar[tuple[str, ...]] = ()
    gives_axes: ClassVar[tuple[str, ...]] = ()
    effect: ClassVar[Effect] = Effect.OTHER
    inverse: ClassVar[str] = ""
    limits: ClassVar[tuple[Interval, ...]] = ()
    knows_unknown: ClassVar[bool] = False

    def forward(self, *values: Any, **named: Any) -> Any:
        """Returns the result: a tuple of parts for messages and for several outputs.

        Raises:
            NoValueError: There is none.
        """
        if not isinstance(self.definition, Definition):
            raise NoValueError(self.name)
        parts: list[float] = []
        for kind, value in zip_longest(self.inputs, values):
            parts += value if kind in PARTS else [value]
        try:
            results = self.definition.compute([*parts, *named.get("near", ())])
        except EvaluationError as error:
            raise NoValueError(self.name) from error
        return results if self.outputs[0] in PARTS or len(results) > 1 else results[0]

    def interval(self, *operands: Any) -> Interval:
        """Returns the range of the result, never narrower than the truth.

        Args:
            operands: Ranges of the inputs, none of which is empty, then the arguments.
        """
        if isinstance(self.definition, Definition) and {*self.inputs, *self.outputs} == {NUMBER}:
            return self.definition.bound(
                [
                    operand if isinstance(operand, tuple) else (operand, operand)
                    for operand in operands
                ]
            )
        return EVERYTHING

    def back(self, *_given: Any, **_named: Any) -> float:
        """Returns the only input that gives a result, where no other conversion leads back."""
        raise NoValueError(self.name)

    def leads_back(self, *_arguments: Any) -> bool:
        """Tells whether each result comes from one number alone."""
        return bool(self.inverse) and self._is_plain

    def loses(self, *_given: Any, **_named: Any) -> bool:
        """Tells whether it drops a part of an input on purpose."""
        return False

    def sign(self, *_arguments: Any) -> int | None:
        """Returns the factor on the sign of a number: 1, -1, or None where it is not known."""
        return _SIGNS.get(self.effect)

    def fault(self, *_arguments: Any, **_named: Any) -> str:
        """Returns the fault of finite arguments; empty when there is none."""
        return ""

    @property
    def changes_nothing(self) -> bool:
        """Whether it only states a fact of the value."""
        return self.units is UnitEffect.STATED

    @property
    def is_of_turns(self) -> bool:
        """Whether whole turns of its result do not count."""
        return self.limits == (TURN,)

    @property
    def keeps_integers(self) -> bool:
        """Whether it makes integers of integers."""
        is_exact = self.effect in (Effect.SAME, Effect.NEGATED)
        return self._is_plain and (is_exact or self.units is UnitEffect.SQUARE)

    @property
    def keeps_size(self) -> bool:
        """Whether integer results have no more digits than the inputs."""
        return self.units is not UnitEffect.SQUARE

    @property
    def needs_clock(self) -> bool:
        """Whether its function is told the present time, as `near`: no TimeStamp has a month."""
        return TIME_STAMP in self.inputs

    @property
    def numbers(self) -> tuple[Argument, ...]:
        """The arguments that are numbers."""
        return tuple(
            argument for argument in self.arguments if argument.kind is ArgumentKind.NUMBER
        )

    @property
    def own_argument(self) -> Argument | None:
        """The argument that is no number, for which the model has a feature of its own."""
        arguments = (
            argument for argument in self.arguments if argument.kind is not ArgumentKind.NUMBER
        )
        return next(arguments, None)

    @property
    def call(self) -> str:
        """The written form, such as `scale(factor)`."""
        names = ", ".join(argument.name for argument in self.arguments)
        return f"{self.name}({names})" if names else self.name

    @property
    def signature(self) -> str:
        """The written form, with inputs, outputs and units."""
        units = self.units.value if isinstance(self.units, UnitEffect) else " ".join(self.units)
        ends = f"{', '.join(self.inputs)} -> {', '.join(self.outputs)}"
        return f"{self.call}: {ends}, units {units}"

    @property
    def documentation(self) -> str:
        """The documentation, which the literal has too."""
        return " ".join((self.__doc__ or "").split())

    def ranges(self, known: Sequence[Interval], arguments: Sequence[Any]) -> list[Interval]:
        """Returns the range of each result.

        Args:
            known: Ranges of the inputs; those of what is no number are infinite.
        """
        if self.limits:
            return list(self.limits)
        if any(map(is_empty, known)):
            return [EMPTY]
        has_inputs = self._takes_several or len(known) == len(self.inputs)
        if not has_inputs or self.fault(*arguments):
            return [EVERYTHING]
        return [self.interval(*known, *arguments)]

    def takes(self, kinds: Sequence[str]) -> bool:
        """Tells whether it takes values of some kinds."""
        if self._takes_several:
            # The truth of a bool counts as 1 in expressions.
            known = [NUMBER if kind == BOOL else kind for kind in kinds]
            return bool(kinds) and all(_matches(kind, self.inputs[0][:-1]) for kind in known)
        return len(kinds) == len(self.inputs) and all(map(_matches, kinds, self.inputs))

    @property
    def _is_plain(self) -> bool:
        """Whether it makes a number of a number, both of which count in full."""
        return self.inputs == self.outputs == (NUMBER,) and not self.is_of_turns

    @property
    def _takes_several(self) -> bool:
        return self.inputs[-1].endswith("+")


def _matches(kind: str, wanted: str) -> bool:
    return wanted == ANY or kind == wanted or kind in _INSTANCES.get(wanted, ())


def linear_interval(value: Interval, factor: float, offset: float = 0.0) -> Interval:
    """Returns the range of the value times a factor plus an offset."""
    # 0 times an infinite end would be no number.
    if factor == 0.0:
        return offset, offset
    return total(product(value, (factor, factor)), (offset, offset))
