"""The compiled core of a bridge: one source of C++ with its codecs and its translations.

Maps that say the same share a function. What has no form in C++ is left to Python.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice

from jausml.generation.literals import printable
from jausml.language.cdr import types_within
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.light_module import LightModule
from jausml_generators.bridge.translation.steps import Step
from jausml_generators.bridge.translation.surroundings import Surroundings
from jausml_generators.common.ros import RosClasses, ros_type
from jausml_generators.cpp.jaus_codec import JausCodec
from jausml_generators.cpp.printing import Printed, printed
from jausml_generators.cpp.ros_codec import RosCodec
from jausml_generators.cpp.types import CORE, Struct, UnprintableError, cpp_name, laid_out, support
from jausml_generators.cpp.values import Used
from jausml_generators.python.codec.messages import FORM_CLASS, MessageView

_PARAMETERS = (("const Source&", "source"), ("Target&", "target"), ("jausml::Check&", "check"))


@dataclass(frozen=True)
class Ends:
    """The source and the target of a translation.

    Attributes:
        message: The JAUS message.
        type: The type of ROS.
        joins: The joined messages, by parameter of the method.
    """

    message: MessageView
    type: ros.MessageType
    joins: Mapping[str, MessageView | ros.MessageType]
    to_ros: bool


@dataclass(frozen=True)
class Compiled:
    """A translation that has a function in C++.

    Attributes:
        function: Name of the function.
        quantities: Attributes of the bridge that are numbers, in the order that it is given them.
        texts: Attributes of the bridge that are texts.
        joins: Parameters of the method that are joined messages.
        unknown: Paths of the fields that it may leave out, in the order of their bits.
    """

    function: str
    quantities: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    joins: tuple[str, ...] = ()
    needs_clock: bool = False
    unknown: tuple[str, ...] = ()

    def renamed(self, named: Callable[[str], str]) -> Compiled:
        """Returns the same function for attributes of other names."""
        quantities, texts = tuple(map(named, self.quantities)), tuple(map(named, self.texts))
        return replace(self, quantities=quantities, texts=texts)


@dataclass
class Core:
    """Collects the translations of a bridge.

    Attributes:
        functions: Their text, by name.
        inputs: What each is printed of.
        left: Why translations are left to Python, by name of the map and direction.
    """

    light: LightModule
    ros_classes: RosClasses
    uses: Surroundings
    functions: dict[str, tuple[str, ...]] = field(default_factory=dict)
    inputs: dict[str, tuple[tuple[Step, ...], Ends]] = field(default_factory=dict)
    left: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._jaus = JausCodec()
        self._names = {part: self.light.name_of(part) for part in self.light.types}
        self._ros = RosCodec(self.light.types, self._names)
        self._by_type = {ros_type(kind): struct for kind, struct in self._ros.structs.items()}
        self._ros_classes: dict[str, Struct] = {}
        self._met = 0
        self._unprintable: dict[str, str] = {}
        self._types: dict[ros.MessageType, None] = {}
        self._used = Used({}, {})
        self._known: dict[tuple[object, ...], str] = {}

    def add(self, name: str, steps: Iterable[Step], ends: Ends) -> Compiled | None:
        """Adds a translation; returns None where it is left to Python.

        Args:
            name: What its function is called, where no other one is.
        """
        steps = tuple(steps)
        # All or nothing: half a translation in C++ would need its other half in Python.
        try:
            source, target = self._structs(ends)
            joins = {join_name: self._struct(what) for join_name, what in ends.joins.items()}
            translation = self._printed(steps, ends)
        except UnprintableError as error:
            self.left.setdefault(name, str(error))
            return None
        function = self._function(name, translation, ends, source, target, joins)
        self.inputs.setdefault(function, (steps, ends))
        self._types |= dict.fromkeys(self._roots(ends))
        return Compiled(
            function,
            translation.quantities,
            translation.texts,
            tuple(joins),
            translation.needs_clock,
            translation.unknown,
        )

    def printed_of(self, function: str, steps: Iterable[Step]) -> tuple[str, ...]:
        """Returns some of the steps of a function, in its names."""
        return self._printed(steps, self.inputs[function][1]).lines

    def structs_of(self, function: str) -> tuple[Struct, Struct]:
        """Returns the structs that a function takes and makes."""
        return self._structs(self.inputs[function][1])

    # -- parts -----------------------------------------------------------------------------------

    def _printed(self, steps: Iterable[Step], ends: Ends) -> Printed:
        source, target = self._structs(ends)
        joins = {join_name: self._struct(what) for join_name, what in ends.joins.items()}
        # Asked anew for each translation: messages and tables are added as they are met.
        self._used.classes = self._classes(ends.message)
        self._used.tables = {
            constant.name: constant.items for constant in self.uses.constants.values()
        }
        return printed(steps, source, target, joins, self._used)

    def _structs(self, ends: Ends) -> tuple[Struct, Struct]:
        both = self._struct(ends.message), self._struct(ends.type)
        return both if ends.to_ros else both[::-1]

    def _struct(self, end: MessageView | ros.MessageType) -> Struct:
        if isinstance(end, MessageView):
            return self._message(end)
        if end not in self._ros.structs:
            raise UnprintableError(f"the type {end.name}")
        return self._ros.structs[end]

    def _message(self, message: MessageView) -> Struct:
        # An attempt that failed is remembered, since many maps may carry the message.
        name = message.class_name
        if name not in self._unprintable and name not in self._jaus.structs:
            try:
                self._jaus.add(message)
            except UnprintableError as error:
                self._unprintable[name] = str(error)
        if name in self._unprintable:
            raise UnprintableError(self._unprintable[name])
        return self._jaus.structs[name]

    def _classes(self, message: MessageView) -> Mapping[str, Struct]:
        """Returns the structs by the names that steps have for classes."""
        # Types are named as they are met; what was met before is known.
        for kind, name in islice(self.ros_classes.names.items(), self._met, None):
            if kind in self._by_type:
                self._ros_classes[name] = self._by_type[kind]
        self._met = len(self.ros_classes.names)
        return ChainMap(self._unnamed(message), self._jaus.structs, self._ros_classes)

    def _unnamed(self, message: MessageView) -> dict[str, Struct]:
        """Returns the structs of a message by the names in the steps of its form."""
        own = message.class_name
        paths = [own, *(getattr(item, "path", "") for item in message.nested)]
        structs = self._jaus.structs
        return {
            path.replace(own, FORM_CLASS, 1): structs[path] for path in paths if path in structs
        }

    @staticmethod
    def _roots(ends: Ends) -> list[ros.MessageType]:
        all_ = (ends.type, *ends.joins.values())
        return [root for root in all_ if not isinstance(root, MessageView)]

    def _function(
        self,
        name: str,
        translation: Printed,
        ends: Ends,
        source: Struct,
        target: Struct,
        joins: Mapping[str, Struct],
    ) -> str:
        # Functions of the same text are one, whatever their maps are called.
        key = (translation.lines, source, target, *joins.values())
        if key in self._known:
            return self._known[key]
        own, count = name, 2
        while own in self.functions:
            own, count = f"{name}_{count}", count + 1
        self._known[key] = own
        how = "joined_ros" if not ends.to_ros else "joined_jaus"
        body = [
            f"const auto {cpp_name(join_name)} = "
            f"jausml::{how}<{struct.cpp}>(live->joins[{at}], check);"
            for at, (join_name, struct) in enumerate(joins.items())
        ]
        text = "\n".join([*body, *translation.lines])
        # A compiler warns of parameters that are not used.
        live, parameters = " live" if "live->" in text else "", []
        for kind, parameter in _PARAMETERS:
            parameters.append(
                f"{kind} {parameter}" if re.search(rf"\b{parameter}\b", text) else kind
            )
        lines = [*body, *translation.lines]
        way = "jaus_to_ros" if ends.to_ros else "ros_to_jaus"
        self.functions[own] = (
            f"JAUSML_EXPORT std::int64_t {own}(",
            "    const std::uint8_t* data, std::size_t size,"
            f" const jausml::Live*{live}, jausml::Made* made) {{",
            f"    using Source = {source.cpp};",
            f"    using Target = {target.cpp};",
            f"    return jausml::{way}<Source, Target>(data, size, made,",
            f"        [&]({', '.join(parameters)}) {{",
            *laid_out(f"            {line}" if line else "" for line in lines),
            "        });",
            "}",
        )
        return own

    # -- the file --------------------------------------------------------------------------------

    @functools.cached_property
    def jaus_lines(self) -> tuple[str, ...]:
        """The structs of the JAUS messages."""
        return tuple(laid_out(self._jaus.lines))

    @functools.cached_property
    def ros_lines(self) -> tuple[str, ...]:
        """The structs of the types of ROS that are used."""
        wanted = types_within(self._types)
        lines = [line for message_type in wanted for line in ("", *self._ros.text[message_type])]
        return tuple(laid_out(lines[1:]))

    @functools.cached_property
    def conversions(self) -> tuple[tuple[str, ...], ...]:
        """The functions of conversions that are called."""
        return tuple(self._used.conversions.values())

    @functools.cached_property
    def constants(self) -> tuple[str, ...]:
        """The tables."""
        return tuple(
            line for constant in self._used.constants.values() for line in laid_out(constant)
        )

    @functools.cached_property
    def left_lines(self) -> tuple[str, ...]:
        """The translations that are left to Python, and why, as text of comments."""
        texts = (printable(f"{name}: {reason}") for name, reason in self.left.items())
        return tuple(" ".join(text.replace("\\", "/").split()) for text in texts)

    @functools.cached_property
    def digest(self) -> str:
        """The checksum by which a library that was compiled of another text is noticed."""
        parts = [self.jaus_lines, self.ros_lines, self.conversions, self.constants]
        # The headers belong to it: a library of older headers must not be loaded.
        text = repr([*parts, self.functions, *map(support, CORE)])
        return hashlib.sha256(text.encode()).hexdigest()[:32]
