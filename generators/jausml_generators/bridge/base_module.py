"""Module of a bridge's base class: what stands in it besides the connections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation import literals as docs
from jausml.generation.literals import printable, python_literal, python_string

if TYPE_CHECKING:
    from jausml_generators.bridge.translation.surroundings import (
        Constant,
        FrameView,
        NestedTranslation,
        QuantityView,
        Surroundings,
        UserMethod,
    )


@dataclass(frozen=True)
class ParameterView:
    """An attribute of the bridge that a parameter of the node may change.

    Attributes:
        is_positive: Whether it is above 0.
    """

    name: str
    attribute: str
    value: float | str
    description: str
    is_positive: bool = False

    @property
    def arguments(self) -> str:
        """Arguments of AttributeParameter, as Python text."""
        texts = map(python_string, (self.name, self.attribute, self.description))
        return ", ".join([*texts, *(["is_positive=True"] if self.is_positive else [])])


@dataclass(frozen=True)
class BaseModule:
    """What the translations of a bridge use of its class and module, as text."""

    uses: Surroundings

    @property
    def constants(self) -> tuple[str, ...]:
        """Statements of the constants of the module."""
        return tuple(map(_constant, self.uses.constants.values()))

    @property
    def quantities(self) -> tuple[QuantityView, ...]:
        """The quantities that conversions use."""
        return tuple(self.uses.quantities.values())

    @property
    def frames(self) -> tuple[FrameView, ...]:
        """The names of frames that translations set."""
        return tuple(self.uses.frames.values())

    @property
    def attributes(self) -> tuple[str, ...]:
        """Statements that give the attributes of the class their first values."""
        quantities = [
            f"self.{each.name} = {python_literal(each.value)}{_unit_comment(each.units)}"
            for each in self.quantities
        ]
        frames = [f"self.{each.name} = {python_string(each.value)}" for each in self.frames]
        memories = [f"self.{each.name}: {each.annotation} = None" for each in self.uses.memories]
        return (*quantities, *frames, *memories)

    @property
    def parameters(self) -> tuple[ParameterView, ...]:
        """The attributes that parameters of the node may change."""
        return (
            *(
                ParameterView(e.name, e.name, e.value, _description(e), e.is_maximum)
                for e in self.quantities
            ),
            *(ParameterView(e.parameter, e.name, e.value, e.about) for e in self.frames),
        )

    @property
    def nested(self) -> tuple[NestedTranslation, ...]:
        """The methods that translate messages inside messages."""
        return tuple(self.uses.nested.values())

    @property
    def methods(self) -> tuple[UserMethod, ...]:
        """The conversions that the user writes."""
        return tuple(self.uses.methods.values())

    @property
    def user_signatures(self) -> tuple[str, ...]:
        """First lines of these methods."""
        return tuple(map(user_signature, self.methods))

    @property
    def stubs(self) -> tuple[str, ...]:
        """The methods of the skeleton that the user completes."""
        return tuple(map(stub, self.methods))


def user_signature(method: UserMethod) -> str:
    """Returns the first line of a conversion that the user writes."""
    pairs = zip(names_of(method), method.inputs, strict=True)
    parameters = [f"{name}: {kind}" for name, kind in pairs]
    return f"def {method.name}({', '.join(['self', *parameters])}) -> {method.output}:"


def stub(method: UserMethod) -> str:
    """Returns the method of the skeleton that the user completes."""
    head = f"    {user_signature(method)}"
    about = docs.docstring(f"The conversion {printable(method.model_name)}.", 8)
    return f"{head}\n        {about}\n        raise NotImplementedError({_missing(method)})\n"


def _missing(method: UserMethod) -> str:
    return python_string(f"{method.name} is not written yet")


def names_of(method: UserMethod) -> tuple[str, ...]:
    """Returns the names of the parameters of a conversion that the user writes."""
    count = len(method.inputs)
    return ("value",) if count == 1 else tuple(f"value{i}" for i in range(1, count + 1))


def _constant(constant: Constant) -> str:
    opening, closing = constant.brackets[0], constant.brackets[1]
    comma = "," if opening == "(" and len(constant.items) == 1 else ""
    value = f"{opening}{', '.join(constant.items)}{comma}{closing}"
    about = " ".join(printable(constant.about).split())
    return f"# {about}\n{constant.name}: {constant.annotation} = {value}"


def _unit_comment(units: str) -> str:
    text = " ".join(printable(units).split())
    return f"  # {text}" if text else ""


def _description(quantity: QuantityView) -> str:
    words = " ".join(printable(quantity.documentation or f"{quantity.name}.").split())
    units = " ".join(printable(quantity.units).split())
    return f"{words.rstrip('.')} ({units})." if units else words
