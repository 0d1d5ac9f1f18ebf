"""Builds the views of messages from the model: resolves types, names, formats and limits."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from jausml.generation import docstrings as docs
from jausml.generation.errors import GenerationError
from jausml.generators.python import names
from jausml.generators.python.codec import fields
from jausml.generators.python.codec.members import Member, Run, Single
from jausml.generators.python.codec.messages import MessageView
from jausml.generators.python.codec.nested import (
    Alternative,
    ContainerClass,
    VariableFieldClass,
    VariantAlias,
)
from jausml.generators.python.codec.nesting import Nest, Resolved, resolve
from jausml.generators.python.codec.values import ArrayValue, ListValue, PartValue, VariantValue
from jausml.generators.python.layout import Call

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

Value = fields.Fixed | fields.Blob | PartValue | VariantValue | ListValue | ArrayValue
Element = fields.Fixed | fields.Blob | PartValue | VariantValue


def build_message(element: Any, class_name: str | None = None) -> MessageView:
    """Returns the view of a message.

    Args:
        element: A MessageDef of the model.
        class_name: Name of the class; made from the message's name when it is not given.

    Raises:
        GenerationError: The message cannot be encoded; validation tells users before.
    """
    return MessageBuilder(element, class_name or names.class_name(str(element.name))).build()


def build_messages(elements: Iterable[Any]) -> tuple[MessageView, ...]:
    """Returns the views of the messages of one module, in the order of their codes.

    A message that occurs more than once (several services of a set define SetTravelSpeed) becomes
    one class; messages that share no more than a name get different ones.

    Args:
        elements: MessageDefs of the model.

    Raises:
        GenerationError: A message cannot be encoded.
    """
    return tuple(dict.fromkeys(build_message_map(elements).values()))


def build_message_map(elements: Iterable[Any]) -> dict[Any, MessageView]:
    """Returns the views of `build_messages` by model element.

    Args:
        elements: MessageDefs of the model.

    Raises:
        GenerationError: A message cannot be encoded.
    """
    scope = names.Scope(names.RESERVED_CLASSES, separator="")
    classes: dict[MessageView, MessageView] = {}
    found: dict[Any, MessageView] = {}
    for element in sorted(elements, key=lambda e: (int(str(e.code), 16), str(e.name))):
        view = build_message(element)
        if view not in classes:
            name = scope.claim(view.class_name)
            classes[view] = view if name == view.class_name else build_message(element, name)
        found[element] = classes[view]
    return found


class MessageBuilder:
    """Builds the view of one message.

    Args:
        element: A MessageDef of the model.
        class_name: Name of the class.
    """

    def __init__(self, element: Any, class_name: str) -> None:
        self._element = element
        self._class_name = class_name
        self._nest = Nest(class_name, str(element.name))
        self._open: list[Any] = []
        self._kinds: dict[str, Callable[[Resolved, str], Value]] = {
            "FixedField": self._number,
            "BitField": self._bits,
            "FixedLengthString": self._fixed_text,
            "VariableLengthString": self._text,
            "VariableLengthField": self._blob,
            "VariableFormatField": self._part,
            "VariableField": self._part,
            "Record": self._part,
            "Sequence": self._part,
            "List": self._list,
            "Array": self._array,
            "Variant": self._variant,
        }

    def build(self) -> MessageView:
        """Returns the view."""
        element = self._element
        code = int(str(element.code), 16)
        body = resolve(element.body) if element.body is not None else None
        summary = f"{docs.clean(element.name)} (message code 0x{code:04X})."
        text = docs.clean(element.documentation)
        container = self._container(
            self._class_name, body, summary, (docs.sentence(text),) if text else ()
        )
        return MessageView(
            jaus_name=str(element.name),
            code=code,
            is_command=bool(element.isCommand),
            body=container,
            nested=tuple(self._nest.classes),
            structs=tuple(sorted(self._nest.structs.items())),
            body_name=body.name if body else "",
            body_kind=body.kind if body else "",
        )

    # -- classes ---------------------------------------------------------------------------------

    def _container(
        self,
        name: str,
        body: Resolved | None,
        summary: str,
        paragraphs: tuple[str, ...] = (),
        tag: int | None = None,
    ) -> ContainerClass:
        """Builds a class of members: those of a record or sequence, or the one field itself."""
        path = self._nest.path(name)
        presence = "none"
        elements: Sequence[Any] = ()
        if body is not None and body.kind in ("Record", "Sequence"):
            if body.type in self._open:
                raise GenerationError(f"'{body.name}' of {self._element.name} contains itself")
            self._open.append(body.type)
            presence = fields.name_of(body.type.presenceVector)
            elements = list(body.type.fields)
        members = self._members(
            path,
            [resolve(e) for e in elements]
            if elements
            else [replace(body, optional=False)]
            if body
            else [],
            presence,
        )
        if elements:
            self._open.pop()
        presence_format = "" if presence == "none" else fields.length_format(presence)
        return ContainerClass(
            name=name,
            path=path,
            summary=summary,
            paragraphs=paragraphs,
            members=members,
            segments=self._segments(members, presence_format),
            presence_struct=self._nest.use(presence_format) if presence_format else "",
            presence_size=fields.bits_of(presence) // 8 if presence_format else 0,
            tag=tag,
            jaus_name=body.name if body else "",
            is_wrapper=body is not None and not elements,
        )

    def _members(
        self, path: str, resolved: Sequence[Resolved], presence: str
    ) -> tuple[Member, ...]:
        scope = names.Scope(names.RESERVED_ATTRIBUTES)
        attributes = [scope.claim(names.snake_case(field.name)) for field in resolved]
        members: list[Member] = []
        bit = 1
        for field, attribute in zip(resolved, attributes, strict=True):
            value = self._value(field, path)
            repeated = isinstance(value, ListValue | ArrayValue)
            first = not any(member.item for member in members)
            optional = field.optional and presence != "none"
            member = Member(
                jaus_name=field.name,
                attribute=attribute,
                value=self._with_reader(value, attribute, scope),
                default="None" if optional else self._default(value, path),
                bit=bit if optional else 0,
                item="" if not repeated else "item" if first else scope.claim(f"{attribute}_item"),
                units=docs.clean(getattr(field.type, "units", "")),
                documentation=field.documentation,
                enumeration=self._nest.enumeration(field, getattr(field.type, "values", None)),
            )
            bit <<= optional
            members.append(member)
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
            if isinstance(member.value, fields.Fixed) and not member.is_optional:
                waiting.append(member)
            else:
                flush()
                segments.append(Single(member))
        flush()
        return tuple(segments)

    def _run(self, members: Sequence[Member], presence_format: str) -> Run:
        formats = [m.value.format for m in members if isinstance(m.value, fields.Fixed)]
        items = [presence_format, *formats] if presence_format else formats
        size = sum(fields.size_of(item) for item in items)
        name = self._nest.use("".join(items))
        return Run(name, tuple(members), bool(presence_format), size)

    def _class(self, field: Resolved, tag: int | None = None) -> PartValue:
        """Returns the class of a field as a part; each option of a variant has its own."""
        key = (id(field.type), field.name, tag)
        if tag is not None or key not in self._nest.known:
            name = self._nest.scope.claim(names.class_name(field.name))
            summary = self._nest.summary(field)
            if field.kind == "VariableField":
                part: ContainerClass | VariableFieldClass = self._variable(field, name, summary)
            elif field.kind == "VariableFormatField":
                part = self._format(field, name, summary)
            else:
                part = self._container(name, field, summary, tag=tag)
            self._nest.classes.append(part)
            self._nest.known[key] = PartValue(part, part.path)
        part_value: PartValue = self._nest.known[key]
        return part_value

    def _variable(self, field: Resolved, name: str, summary: str) -> VariableFieldClass:
        numbers = [
            fields.number(fields.name_of(a.type), a.scale, a.values)
            for a in field.type.alternatives
        ]
        python_type = "float" if any(n.python_type == "float" for n in numbers) else "int"
        alternatives = []
        for element, value in zip(field.type.alternatives, numbers, strict=True):
            self._nest.use(value.format)
            number = fields.as_real(value) if python_type == "float" else value
            alternatives.append(
                Alternative(
                    int(element.index), number, str(element.name), docs.clean(element.units)
                )
            )
        self._nest.use("B")
        return VariableFieldClass(
            name, self._nest.path(name), summary, python_type, tuple(alternatives), field.name
        )

    def _format(self, field: Resolved, name: str, summary: str) -> ContainerClass:
        """Builds the class of a variable format field: the index of a format, and bytes."""
        path = self._nest.path(name)
        indices = [(int(f.index), str(f.name)) for f in field.type.formats]
        enumeration = self._nest.listed(f"{name}Format", docs.clean(field.name), indices)
        ranges = fields.merge((index, index) for index, _ in indices)
        index = Member(
            "format",
            "format_index",
            fields.integer("B", ranges),
            str(min(indices)[0]),
            enumeration=enumeration,
        )
        blob = self._counted(field, "format", is_text=False)
        data = Member("hex", "data", blob, blob.default)
        members = (index, data)
        segments = self._segments(members, "")
        return ContainerClass(
            name, path, summary, (), members, segments, jaus_name=field.name, is_format=True
        )

    # -- values ----------------------------------------------------------------------------------

    def _value(self, field: Resolved, path: str) -> Value:
        return self._kinds[field.kind](field, path)

    def _number(self, field: Resolved, path: str) -> fields.Fixed:
        del path
        element = field.type
        value = fields.number(fields.name_of(element.type), element.scale, element.values)
        self._nest.use(value.format)
        return value

    def _bits(self, field: Resolved, path: str) -> fields.Fixed:
        del path
        struct_format = self._nest.used(fields.length_format(fields.name_of(field.type.type)))
        name = self._nest.bit_field(field).path
        return fields.Bits(struct_format, name, "", "", (), reader=f"{name}.from_integer")

    def _fixed_text(self, field: Resolved, path: str) -> fields.Fixed:
        del path
        value = fields.fixed_text(int(field.type.length))
        self._nest.use(value.format)
        return value

    def _text(self, field: Resolved, path: str) -> fields.Blob:
        del path
        return self._counted(field, "text", is_text=True)

    def _blob(self, field: Resolved, path: str) -> fields.Blob:
        del path
        return self._counted(field, docs.clean(field.type.format), is_text=False)

    def _counted(self, field: Resolved, content: str, *, is_text: bool) -> fields.Blob:
        count_type = fields.name_of(field.type.countType)
        lower, upper = fields.count_limits(
            count_type, int(field.type.minimumLength), int(field.type.maximumLength)
        )
        count_format = self._nest.used(fields.length_format(count_type))
        return fields.Blob(count_format, lower, upper, is_text, content)

    def _part(self, field: Resolved, path: str) -> PartValue:
        del path
        return self._class(field)

    def _list(self, field: Resolved, path: str) -> ListValue:
        element = field.type
        count_type = fields.name_of(element.countType)
        lower, upper = fields.count_limits(
            count_type, int(element.minimumCount), int(element.maximumCount)
        )
        count_format = self._nest.used(fields.length_format(count_type))
        return ListValue(self._item(resolve(element.element), path), count_format, lower, upper)

    def _array(self, field: Resolved, path: str) -> ArrayValue:
        item = self._item(resolve(field.type.element), path)
        array = ArrayValue(item, tuple(int(size) for size in field.type.dimensions))
        if isinstance(item, fields.Fixed) and not item.format.endswith("s"):
            name = self._nest.use(f"{array.count}{item.format}")
            return replace(array, struct=name)
        return array

    def _item(self, field: Resolved, path: str) -> Element:
        """Returns an element of a list or array; a list in a list gets a class around it."""
        value = self._value(field, path)
        return self._class(field) if isinstance(value, ListValue | ArrayValue) else value

    def _variant(self, field: Resolved, path: str) -> fields.Fixed | VariantValue:
        del path
        tag_format = self._nest.used(fields.length_format(fields.name_of(field.type.tagType)))
        resolved = [resolve(option) for option in field.type.options]
        if not resolved:
            return fields.Tag(tag_format, "int", "0", "integer", ("0", "0"))
        if len(resolved) == 1:
            only = self._class(resolved[0], 0)
            return VariantValue("", only.python_type, tag_format, (only,))
        alias = self._nest.scope.claim(names.class_name(field.name))
        options = tuple(self._class(option, tag) for tag, option in enumerate(resolved))
        classes = tuple(option.part.name for option in options)
        self._nest.classes.append(VariantAlias(alias, classes))
        return VariantValue("", self._nest.path(alias), tag_format, options)

    def _default(self, value: Value, path: str) -> Call | str:
        if isinstance(value, ListValue):
            return Call("field", ("default_factory=list",))
        if isinstance(value, ArrayValue):
            return Call("field", (f"default_factory=lambda: {self._elements(value)}",))
        if isinstance(value, VariantValue):
            return self._factory(value.options[0].python_type, path)
        if isinstance(value, PartValue | fields.Bits):
            return self._factory(value.python_type, path)
        return value.default

    def _factory(self, class_path: str, path: str) -> Call:
        # A class inside a class is not in sight of its neighbours until the outer one is made.
        if path == self._class_name:
            return Call("field", (f"default_factory={class_path.rpartition('.')[2]}",))
        return Call("field", (f"default_factory=lambda: {class_path}()",))

    def _elements(self, array: ArrayValue) -> str:
        element = array.element
        if isinstance(element, fields.Fixed | fields.Blob) and not isinstance(element, fields.Bits):
            return f"[{element.default}] * {array.count}"
        first = element.options[0] if isinstance(element, VariantValue) else element
        return f"[{first.python_type}() for _ in range({array.count})]"
