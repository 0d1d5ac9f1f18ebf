"""Builder of the views of messages: resolves types, names, formats and limits."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from dataclasses import replace

from jausml.generation import literals as docs
from jausml.generation.errors import GenerationError
from jausml.generation.python.modules import STANDARD
from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.subject import remembered
from jausml_generators.python import names
from jausml_generators.python.codec import scalars
from jausml_generators.python.codec.classes import (
    Alternative,
    ContainerClass,
    Format,
    VariableFieldClass,
    VariantAlias,
)
from jausml_generators.python.codec.members import (
    ArrayValue,
    ListValue,
    Member,
    PartValue,
    Run,
    Single,
    VariantValue,
)
from jausml_generators.python.codec.messages import FORM_CLASS, MessageScope, MessageView
from jausml_generators.python.package import runtime_names

Element = scalars.Fixed | scalars.Blob | PartValue | VariantValue
Value = Element | ListValue | ArrayValue


@remembered
def build_message(element: jaus.MessageDef) -> MessageView:
    """Returns the view of a message, whose class is named after it."""
    return _view(element)


def _view(element: jaus.MessageDef, class_name: str = "") -> MessageView:
    try:
        layout = wire.resolve(element)
    except wire.LayoutError as error:
        raise GenerationError(str(error)) from None
    return MessageBuilder(layout, class_name or names.class_name(layout.name)).build()


def build_unnamed(view: MessageView) -> MessageView:
    """Returns the view of all messages of the form of one, with FORM_CLASS for their class.

    It is that of the message itself if no other has its form.
    """
    return view if view.is_named_inside else MessageBuilder(view.unnamed, FORM_CLASS).build()


def build_messages(elements: Iterable[jaus.MessageDef]) -> tuple[MessageView, ...]:
    """Returns the views of the messages of one module, in the order of their codes.

    A message that occurs more than once (several services of a set define SetTravelSpeed) becomes
    one class; messages that share no more than a name get different ones.
    """
    return tuple(dict.fromkeys(build_message_map(elements).values()))


def build_message_map(elements: Iterable[jaus.MessageDef]) -> dict[jaus.MessageDef, MessageView]:
    """Returns the views of `build_messages` by model element."""
    # Modules that use messages import these too.
    taken = {*names.WIRE, *runtime_names(), *STANDARD, *names.CONSTANTS}
    scope = names.Scope(frozenset(taken), separator="")
    classes: dict[MessageView, MessageView] = {}
    views_by_element: dict[jaus.MessageDef, MessageView] = {}
    for element in sorted(
        dict.fromkeys(elements), key=lambda element: (int(str(element.code), 16), str(element.name))
    ):
        view = build_message(element)
        if view not in classes:
            name = scope.claim(view.class_name)
            classes[view] = view if name == view.class_name else _view(element, name)
        views_by_element[element] = classes[view]
    return views_by_element


class MessageBuilder:
    """Builds the view of one message."""

    def __init__(self, layout: wire.Message, class_name: str) -> None:
        self._layout = layout
        self._class_name = class_name
        self._scope = MessageScope(class_name, layout.name)

    def build(self) -> MessageView:
        """Returns the view."""
        layout = self._layout
        summary = f"{docs.clean(layout.name)} (message code 0x{layout.code:04X})."
        text = docs.clean(layout.documentation)
        paragraphs = (docs.sentence(text),) if text else ()
        container = self._container(self._class_name, layout.body, summary, paragraphs)
        return MessageView(
            jaus_name=layout.name,
            code=layout.code,
            is_command=layout.is_command,
            body=container,
            nested=tuple(self._scope.classes),
            structs=tuple(sorted(self._scope.structs.items())),
            layout=layout,
        )

    # -- classes ---------------------------------------------------------------------------------

    def _container(
        self,
        name: str,
        body: wire.Field | None,
        summary: str,
        paragraphs: tuple[str, ...] = (),
        tag: int | None = None,
    ) -> ContainerClass:
        """Builds a class of members: those of a record or sequence, or the only field."""
        path = self._scope.path(name)
        presence: wire.IntegerType | None = None
        known_bits = 0
        parts: tuple[wire.Field, ...] = ()
        is_wrapper = body is not None and not isinstance(body.kind, wire.Record)
        if body is not None and isinstance(body.kind, wire.Record):
            parts, presence = body.kind.members, body.kind.presence
            known_bits = body.kind.known_bits
        elif body is not None:
            parts = (replace(body, bit=0),)
        members = self._members(path, parts)
        presence_format = presence.format if presence else ""
        return ContainerClass(
            name=name,
            path=path,
            summary=summary,
            paragraphs=paragraphs,
            members=members,
            segments=self._segments(members, presence_format),
            presence_struct=self._scope.use(presence_format) if presence else "",
            presence_size=presence.size if presence else 0,
            presence_mask=known_bits,
            tag=tag,
            jaus_name=body.name if body else "",
            is_wrapper=is_wrapper,
        )

    def _members(self, path: str, parts: Sequence[wire.Field]) -> tuple[Member, ...]:
        scope = names.Scope(names.RESERVED_ATTRIBUTES)
        attributes = [scope.claim(names.snake_case(field.name)) for field in parts]
        members: list[Member] = []
        first = True
        for field, attribute in zip(parts, attributes, strict=True):
            kind = field.kind
            value = self._value(field)
            repeated = isinstance(value, ListValue | ArrayValue)
            listed = kind.legal.listed if isinstance(kind, wire.Integer) else ()
            member = Member(
                jaus_name=field.name,
                attribute=attribute,
                value=self._with_reader(value, attribute, scope),
                default="None" if field.is_optional else self._default(value, path),
                bit=field.bit,
                item="" if not repeated else "item" if first else scope.claim(f"{attribute}_item"),
                units=docs.clean(kind.units) if isinstance(kind, wire.Number) else "",
                documentation=docs.clean(field.documentation),
                enumeration=self._scope.enumeration(field.name, listed),
            )
            members.append(member)
            first = first and not repeated
        return tuple(members)

    def _with_reader(self, value: Value, attribute: str, scope: names.Scope) -> Value:
        """Names the method of the class that reads a variant."""
        if isinstance(value, VariantValue):
            return replace(value, reader=scope.claim(f"read_{attribute}"))
        if isinstance(value, ListValue | ArrayValue) and isinstance(value.element, VariantValue):
            reader = scope.claim(f"read_{attribute}")
            return replace(value, element=replace(value.element, reader=reader))
        return value

    def _segments(
        self, members: Sequence[Member], presence_format: str
    ) -> tuple[Run | Single, ...]:
        """Groups the members: those of fixed size that are always there share a struct."""
        segments: list[Run | Single] = []
        waiting: list[Member] = []
        head = bool(presence_format)

        def flush() -> None:
            nonlocal head
            if waiting or head:
                segments.append(self._run(waiting, presence_format if head else ""))
            waiting.clear()
            head = False

        for member in members:
            if isinstance(member.value, scalars.Fixed) and not member.is_optional:
                waiting.append(member)
            else:
                flush()
                segments.append(Single(member))
        flush()
        return tuple(segments)

    def _run(self, members: Sequence[Member], presence_format: str) -> Run:
        formats = [
            member.value.format for member in members if isinstance(member.value, scalars.Fixed)
        ]
        items = [presence_format, *formats] if presence_format else formats
        size = struct.calcsize("<" + "".join(items))
        name = self._scope.use("".join(items))
        return Run(name, tuple(members), bool(presence_format), size)

    def _class(self, field: wire.Field, tag: int | None = None) -> PartValue:
        """Returns the class of a field as a part; each option of a variant has its own."""
        key = (field.kind, field.name, tag)
        if tag is not None or key not in self._scope.known:
            name = self._scope.claim(names.class_name(field.name))
            with self._scope.inside(name):
                part = self._class_named(name, field, tag)
            self._scope.classes.append(part)
            self._scope.known[key] = PartValue(part, part.path)
        part_value: PartValue = self._scope.known[key]
        return part_value

    def _class_named(
        self, name: str, field: wire.Field, tag: int | None
    ) -> ContainerClass | VariableFieldClass:
        summary = self._scope.summary(field)
        match field.kind:
            case wire.VariableNumber():
                return self._variable(field.name, field.kind, name, summary)
            case wire.FormattedOctets():
                return self._formatted(field.name, field.kind, name, summary)
        return self._container(name, field, summary, tag=tag)

    def _variable(
        self, jaus_name: str, kind: wire.VariableNumber, name: str, summary: str
    ) -> VariableFieldClass:
        numbers = [scalars.number(alternative.number) for alternative in kind.alternatives]
        python_type = "float" if any(number.python_type == "float" for number in numbers) else "int"
        alternatives = []
        for alternative, value in zip(kind.alternatives, numbers, strict=True):
            self._scope.use(value.format)
            number = scalars.as_real(value) if python_type == "float" else value
            units = docs.clean(alternative.number.units)
            alternatives.append(Alternative(alternative.index, number, alternative.name, units))
        self._scope.use("B")
        path = self._scope.path(name)
        return VariableFieldClass(name, path, summary, python_type, tuple(alternatives), jaus_name)

    def _formatted(
        self, jaus_name: str, kind: wire.FormattedOctets, name: str, summary: str
    ) -> ContainerClass:
        """Builds the class of bytes with a format: the index of the format, and the bytes."""
        indices = [(data_format.index, data_format.name) for data_format in kind.formats]
        enumeration = self._scope.listed(f"{name}Format", docs.clean(jaus_name), indices)
        ranges = wire.merged((index, index) for index, _ in indices)
        index = Member(
            "format",
            "format_index",
            scalars.integer("B", ranges),
            str(min(indices)[0]),
            enumeration=enumeration,
        )
        blob = self._counted(kind.count, "format", is_text=False)
        members = (index, Member("hex", "data", blob, blob.default))
        segments = self._segments(members, "")
        path = self._scope.path(name)
        formats = tuple(Format(at, blob, format_name) for at, format_name in indices)
        return ContainerClass(
            name, path, summary, (), members, segments, jaus_name=jaus_name, formats=formats
        )

    # -- values ----------------------------------------------------------------------------------

    def _value(self, field: wire.Field) -> Value:
        match field.kind:
            case wire.Integer() | wire.Real() | wire.Scaled():
                return self._fixed(scalars.number(field.kind))
            case wire.BitField():
                bit_field = self._scope.bit_field(field, field.kind)
                struct_format = field.kind.type.format
                bits = scalars.Bits(
                    struct_format,
                    bit_field.path,
                    "",
                    "",
                    (),
                    reader=f"{bit_field.path}.from_integer",
                    is_stamp=bit_field.is_inherited,
                )
                return self._fixed(bits)
            case wire.FixedText():
                return self._fixed(scalars.fixed_text(field.kind.length))
            case wire.Text():
                return self._counted(field.kind.count, "text", is_text=True)
            case wire.Octets():
                content = docs.clean(field.kind.content)
                return self._counted(field.kind.count, content, is_text=False)
            case wire.List():
                return self._list(field.kind)
            case wire.Array():
                return self._array(field.kind)
            case wire.Variant():
                return self._variant(field.name, field.kind)
            case wire.VariableNumber() | wire.FormattedOctets() | wire.Record():
                return self._class(field)

    def _fixed(self, value: scalars.Fixed) -> scalars.Fixed:
        self._scope.use(value.format)
        return value

    def _counted(self, count: wire.Count, content: str, *, is_text: bool) -> scalars.Blob:
        count_format = self._scope.used(count.type.format)
        return scalars.Blob(count_format, count.lower, count.upper, is_text, content)

    def _list(self, kind: wire.List) -> ListValue:
        count_format = self._scope.used(kind.count.type.format)
        return ListValue(self._item(kind.element), count_format, kind.stated, kind.count.upper)

    def _array(self, kind: wire.Array) -> ArrayValue:
        item = self._item(kind.element)
        array = ArrayValue(item, kind.dimensions)
        if isinstance(item, scalars.Fixed) and not item.format.endswith("s"):
            return replace(array, struct=self._scope.use(f"{array.count}{item.format}"))
        return array

    def _item(self, field: wire.Field) -> Element:
        """Returns an element of a list or array; a list in a list gets a class around it."""
        value = self._value(field)
        return self._class(field) if isinstance(value, ListValue | ArrayValue) else value

    def _variant(self, name: str, kind: wire.Variant) -> scalars.Fixed | VariantValue:
        tag_format = self._scope.used(kind.tag.format)
        if not kind.options:
            zero, reach = ((0, 0),), (0, kind.tag.upper)
            limits = ("0", "0")
            return scalars.Tag(tag_format, "int", "0", "integer", limits, ranges=zero, reach=reach)
        if len(kind.options) == 1:
            only = self._class(kind.options[0], 0)
            return VariantValue("", only.python_type, tag_format, (only,))
        alias = self._scope.claim(names.class_name(name))
        options = tuple(self._class(option, tag) for tag, option in enumerate(kind.options))
        classes = tuple(option.part.name for option in options)
        self._scope.classes.append(VariantAlias(alias, classes))
        return VariantValue("", self._scope.path(alias), tag_format, options)

    def _default(self, value: Value, path: str) -> str:
        if isinstance(value, ListValue):
            return "field(default_factory=list)"
        if isinstance(value, ArrayValue):
            return f"field(default_factory=lambda: {self._elements(value)})"
        if isinstance(value, VariantValue):
            return self._factory(value.options[0].python_type, path)
        if isinstance(value, PartValue | scalars.Bits):
            return self._factory(value.python_type, path)
        return value.default

    def _factory(self, class_path: str, path: str) -> str:
        # A class inside a class is not in sight of its neighbours until the outer one is made, and
        # one of the base never is.
        if path == self._class_name and not self._scope.is_inherited(class_path):
            return f"field(default_factory={class_path.rpartition('.')[2]})"
        return f"field(default_factory=lambda: {class_path}())"

    def _elements(self, array: ArrayValue) -> str:
        element = array.element
        if isinstance(element, scalars.Fixed | scalars.Blob) and not isinstance(
            element, scalars.Bits
        ):
            return f"[{element.default}] * {array.count}"
        first = element.options[0] if isinstance(element, VariantValue) else element
        return f"[{first.python_type}() for _ in range({array.count})]"
