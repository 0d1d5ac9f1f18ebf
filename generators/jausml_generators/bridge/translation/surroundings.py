"""What translations use of the class of a bridge and its module: constants, frames, methods."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

from jausml.generation import literals as docs
from jausml.generation.literals import printable, python_literal, python_string
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics.assignments.steps import value_of
from jausml.language.semantics.assignments.units import unit_step
from jausml_generators.bridge.translation.values import AssignmentError
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.names import Scope, constant_name, snake_case


@dataclass(frozen=True)
class Constant:
    """A constant of the module.

    Attributes:
        brackets: What stands around them: `{}` or `()`.
        about: What it is, in plain text.
    """

    name: str
    annotation: str
    items: tuple[str, ...]
    brackets: str
    about: str


@dataclass(frozen=True)
class QuantityView:
    """A quantity of the maps, an attribute of the bridge.

    Attributes:
        units: Its unit; empty when the model has none.
        is_maximum: Whether values are measured against it or limited by it, so that it is above 0.
    """

    name: str
    value: float
    units: str
    documentation: str
    is_maximum: bool = False


@dataclass(frozen=True)
class FrameView:
    """A frame of a connection, an attribute of the bridge.

    Attributes:
        parameter: Its name as parameter, e.g. `pose.frame_id`.
        about: Which one it is, in plain text.
    """

    name: str
    parameter: str
    value: str
    about: str


@dataclass(frozen=True)
class UserMethod:
    """A conversion that the user writes.

    Attributes:
        name: Name of the method, e.g. `convert_gear`.
    """

    name: str
    model_name: str
    inputs: tuple[str, ...]
    output: str


@dataclass(frozen=True)
class Memory:
    """An attribute that keeps a value from one message to the next.

    Attributes:
        annotation: Its type, None included.
    """

    name: str
    annotation: str


@dataclass
class NestedTranslation:
    """A method that translates a message inside another one.

    Attributes:
        lines: Its statements; none while they are written.
    """

    name: str
    source_name: str
    target_name: str
    documentation: str
    lines: tuple[str, ...] = ()


@dataclass
class Surroundings:
    """The parts of a class that its translations use.

    Attributes:
        type_name: Returns the name of the class of a ROS type, which the module then imports.
        overrides: Quantities of the bridge by name, which stand for those of maps.
        frames: The names of frames, by connection, last part of the path and value.
        unit_steps: The steps between units that were asked for, by assignment.
        methods: The conversions that the user writes, by name.
        nested: The translations of messages inside others, by connection, map and direction.
    """

    view_of: Callable[[jaus.MessageDef], MessageView]
    type_name: Callable[[ros.MessageType], str]
    overrides: dict[str, bridge.Quantity] = field(default_factory=dict)
    attributes: Scope = field(default_factory=Scope)
    constant_names: Scope = field(default_factory=Scope)
    constants: dict[object, Constant] = field(default_factory=dict)
    quantities: dict[object, QuantityView] = field(default_factory=dict)
    frames: dict[tuple[str, str, str], FrameView] = field(default_factory=dict)
    frame_parameters: set[str] = field(default_factory=set)
    unit_steps: dict[object, tuple[float, float] | None] = field(default_factory=dict)
    methods: dict[str, UserMethod] = field(default_factory=dict)
    memories: list[Memory] = field(default_factory=list)
    nested: dict[object, NestedTranslation] = field(default_factory=dict)

    def constant(
        self, name: str, annotation: str, items: Sequence[str], brackets: str, about: str
    ) -> str:
        """Returns the name of a constant of the module; equal ones of one name share it.

        Args:
            about: What it is, in plain text.
        """
        key = (name, annotation, tuple(items))
        if key not in self.constants:
            claimed = self.constant_names.claim(constant_name(name))
            self.constants[key] = Constant(claimed, annotation, tuple(items), brackets, about)
        return self.constants[key].name

    def unit_step(
        self,
        attribute_map: bridge.AttributeMap,
        assignment: bridge.FieldAssignment,
        *,
        to_ros: bool,
    ) -> tuple[float, float] | None:
        """Returns the result of `semantics.units.unit_step`; connections of one map share it."""
        key = (attribute_map, assignment, to_ros)
        if key not in self.unit_steps:
            self.unit_steps[key] = unit_step(attribute_map, assignment, to_ros=to_ros)
        return self.unit_steps[key]

    def quantity(self, quantity: bridge.Quantity, *, is_maximum: bool) -> str:
        """Returns the attribute of a quantity, whose value a parameter may change."""
        key = self._quantity_key(quantity)
        if key not in self.quantities:
            replacement = self.overrides.get(quantity.name, quantity)
            about = replacement.documentation or quantity.documentation or ""
            name = self.attributes.claim(snake_case(quantity.name))
            self.quantities[key] = QuantityView(name, *key[1:], str(about))
        # Asked by one conversion, it holds for all that use the quantity.
        if is_maximum:
            self.quantities[key] = replace(self.quantities[key], is_maximum=True)
        return self.quantities[key].name

    def frame(self, connection: str, path: str, value: str) -> str:
        """Returns the attribute of the name of a frame, which a parameter may change.

        Args:
            connection: The connection, by its name in Python.
            path: Path of the field, e.g. `header.frame_id`. Those that end alike and have the same
                value are one frame.
        """
        last = path.rpartition(".")[2]
        key = (connection, last, value)
        if key not in self.frames:
            # Two frames that end alike need the full path to be told apart.
            short = f"{connection}.{last}"
            parameter = short if short not in self.frame_parameters else f"{connection}.{path}"
            self.frame_parameters.add(parameter)
            name = self.attributes.claim(snake_case(parameter.replace(".", "_")))
            about = f"Frame in {path} of {connection}."
            self.frames[key] = FrameView(name, parameter, value, about)
        return self.frames[key].name

    def overridden(self, quantities: Iterable[bridge.Quantity]) -> dict[str, float]:
        """Returns the values that maps state for quantities that the bridge replaces.

        Args:
            quantities: Each a `bridge.Quantity` of a map.

        Returns:
            The values of the maps by names of attributes, of those that are used.
        """
        values: dict[str, float] = {}
        for quantity in quantities:
            used = self.quantities.get(self._quantity_key(quantity))
            # Where both state the same value, there is nothing to tell the user.
            if used is not None and used.value != quantity.value:
                values.setdefault(used.name, float(quantity.value))
        return values

    def _quantity_key(self, quantity: bridge.Quantity) -> tuple[str, float, str]:
        """Returns name, value and unit: quantities that are equal in them are one attribute."""
        replacement = self.overrides.get(quantity.name, quantity)
        value = value_of(quantity, self.overrides)
        return str(quantity.name), value, str(quantity.units or replacement.units or "")

    def user_method(self, method: str, inputs: Sequence[str], output: str) -> str:
        """Returns the method of a conversion that the user writes."""
        if method not in self.methods:
            name = self.attributes.claim(f"convert_{snake_case(method)}")
            self.methods[method] = UserMethod(name, method, tuple(inputs), output)
        known = self.methods[method]
        if len(known.inputs) != len(inputs):
            raise AssignmentError(f"user conversion '{method}' takes {len(known.inputs)} values")
        pairs = zip(known.inputs, inputs, strict=True)
        # Two uses of one method may give it different kinds, and its signature must take both.
        self.methods[method] = UserMethod(
            known.name,
            method,
            tuple(_either(first, second) for first, second in pairs),
            _either(known.output, output, "Any"),
        )
        return known.name

    def memory(self, name: str, annotation: str) -> str:
        """Returns the attribute that keeps a value; None before the first."""
        claimed = self.attributes.claim(f"last_{name}")
        self.memories.append(Memory(claimed, f"{annotation} | None"))
        return claimed


def _either(first: str, second: str, otherwise: str = "") -> str:
    if first == second:
        return first
    both = {*first.split(" | "), *second.split(" | ")}
    return otherwise or " | ".join(sorted(both))


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
    """The parts of a bridge's class and module that translations use, as text."""

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
            f"self.{quantity.name} = {python_literal(quantity.value)}"
            f"{_unit_comment(quantity.units)}"
            for quantity in self.quantities
        ]
        frames = [f"self.{frame.name} = {python_string(frame.value)}" for frame in self.frames]
        memories = [
            f"self.{memory.name}: {memory.annotation} = None" for memory in self.uses.memories
        ]
        return (*quantities, *frames, *memories)

    @property
    def parameters(self) -> tuple[ParameterView, ...]:
        """The attributes that parameters of the node may change."""
        return (
            *(
                ParameterView(
                    quantity.name,
                    quantity.name,
                    quantity.value,
                    _description(quantity),
                    quantity.is_maximum,
                )
                for quantity in self.quantities
            ),
            *(
                ParameterView(frame.parameter, frame.name, frame.value, frame.about)
                for frame in self.frames
            ),
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
    return ("value",) if count == 1 else tuple(f"value{number}" for number in range(1, count + 1))


def _constant(constant: Constant) -> str:
    opening, closing = constant.brackets[0], constant.brackets[1]
    # Python reads `(x)` as x, not as a tuple.
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
