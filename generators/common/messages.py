"""What templates/messages.py.j2 may ask about messages: everything is computed here, once.

A message body is a tree of containers (AS5684: record, sequence, list, variant). In Python a
message is a dataclass of the members of its body; a container inside it is a dataclass inside the
class, a list is a list, a variant a union of the classes of its options.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from jausml.generators.common import docs, imports, layout
from jausml.generators.common.layout import Call
from jausml.generators.common.values import MAXIMUM_COMPLEXITY, VariantValue

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

    from jausml.generators.common.fields import Blob, Fixed
    from jausml.generators.common.values import ArrayValue, ListValue, PartValue


@dataclass(frozen=True)
class Member:
    """An attribute of a message or part.

    Attributes:
        jaus_name: Name in the model.
        attribute: Name in Python.
        value: What it holds.
        default: Default value, as Python text.
        item: Name of a local for an element, when the value is a list or an array.
        bit: Its bit in the presence vector; 0 when it is always there.
        units: Unit, as the model says it.
        documentation: Clean text of the model.
        enumeration: Name of the class of its listed values, or empty.
    """

    jaus_name: str
    attribute: str
    value: Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue
    default: Call | str
    item: str = ""
    bit: int = 0
    units: str = ""
    documentation: str = ""
    enumeration: str = ""

    @property
    def is_optional(self) -> bool:
        """Whether the presence vector says if it is there."""
        return self.bit != 0

    @property
    def annotation(self) -> str:
        """Type in Python, None included."""
        return f"{self.value.python_type} | None" if self.is_optional else self.value.python_type

    @property
    def result(self) -> Call | str:
        """The value, as Python text, when its bytes were read into a local of its name."""
        if self.value.kind == "fixed" and not self.is_optional:
            return self.value.unpack(self.attribute)  # type: ignore[union-attr]
        return self.attribute

    def start(self, column: int) -> str:
        """Returns the assignment of an empty list to a local of its name.

        Args:
            column: Column at which it will stand.
        """
        if self.is_optional:
            return f"{self.attribute} = []"
        return layout.annotated(self.attribute, self.value.python_type, "[]", column)

    def line(self, column: int) -> str:
        """Returns its line in the class, or several when it is long.

        Args:
            column: Column at which it will stand.
        """
        return layout.annotated(self.attribute, self.annotation, self.default, column)

    @property
    def description(self) -> str:
        """What the docstring says of it."""
        numbers = getattr(self.value, "range_text", "")
        facts = [
            " ".join(filter(None, [numbers, self.units])),
            f"see {self.enumeration}" if self.enumeration else "",
            "optional" if self.is_optional else "",
        ]
        text = "; ".join(filter(None, facts))
        first = docs.sentence(self.documentation or self.jaus_name)
        return f"{first} {docs.sentence(text)}" if text else first


@dataclass(frozen=True)
class Run:
    """Members of fixed size one after the other, packed by one struct.

    Attributes:
        struct: Name of the module's constant.
        members: The members.
        has_presence: Whether the presence vector comes before them.
        size: Bytes.
    """

    kind: ClassVar[str] = "run"
    struct: str
    members: tuple[Member, ...]
    has_presence: bool
    size: int

    @property
    def packed(self) -> tuple[Call | str, ...]:
        """Arguments of the struct's pack."""
        calls = tuple(
            member.value.pack(f"self.{member.attribute}", member.attribute)  # type: ignore[union-attr]
            for member in self.members
        )
        # The presence vector is written over this 0 when all members are known.
        return ("0", *calls) if self.has_presence else calls

    @property
    def targets(self) -> tuple[str, ...]:
        """Names that the struct's unpack assigns."""
        names = tuple(member.attribute for member in self.members)
        return ("presence", *names) if self.has_presence else names


@dataclass(frozen=True)
class Single:
    """A member that is read and written by itself.

    Attributes:
        member: The member.
    """

    kind: ClassVar[str] = "single"
    member: Member


@dataclass(frozen=True)
class Enumeration:
    """The listed values of a field.

    Attributes:
        name: Name of the class.
        of: What it lists the values of, clean text.
        constants: Names and values.
    """

    kind: ClassVar[str] = "enumeration"
    name: str
    of: str
    constants: tuple[tuple[str, int], ...]

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class.

        Args:
            column: Column at which it will stand.
        """
        return docs.docstring(f"Values of {self.of}.", column)


@dataclass(frozen=True)
class SubField:
    """A group of bits of a bit field.

    Attributes:
        jaus_name: Name in the model.
        attribute: Name in Python.
        low: Lowest bit.
        mask: Its bits, shifted down.
        value: Its legal values.
        documentation: Clean text of the model.
        enumeration: Name of the class of its listed values, or empty.
    """

    jaus_name: str
    attribute: str
    low: int
    mask: int
    value: Fixed
    documentation: str = ""
    enumeration: str = ""

    @property
    def shift(self) -> str:
        """What moves the value to its place in the integer."""
        return f" << {self.low}" if self.low else ""

    @property
    def packed(self) -> Call:
        """The checked value."""
        return self.value.pack(f"self.{self.attribute}", self.attribute)

    @property
    def extracted(self) -> str:
        """The value out of the integer `bits`."""
        return f"bits >> {self.low} & 0x{self.mask:X}" if self.low else f"bits & 0x{self.mask:X}"

    @property
    def description(self) -> str:
        """What the docstring says of it."""
        see = f"; see {self.enumeration}" if self.enumeration else ""
        first = docs.sentence(self.documentation or self.jaus_name)
        return f"{first} {self.value.range_text}{see}."


@dataclass(frozen=True)
class BitFieldClass:
    """The class of a bit field.

    Attributes:
        name: Name of the class.
        path: Full name.
        summary: First line of the docstring.
        sub_fields: The groups of bits.
    """

    kind: ClassVar[str] = "bit_field"
    name: str
    path: str
    summary: str
    sub_fields: tuple[SubField, ...]

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class.

        Args:
            column: Column at which it will stand.
        """
        return docs.docstring(self.summary, column, (), self.attributes)

    @property
    def extracted(self) -> tuple[str, ...]:
        """Arguments of the constructor out of the integer `bits`."""
        return tuple(sub.extracted for sub in self.sub_fields)

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """Names and descriptions for the docstring."""
        return tuple((sub.attribute, sub.description) for sub in self.sub_fields)


@dataclass(frozen=True)
class Alternative:
    """A type that a variable field may take.

    Attributes:
        index: Its index on the wire.
        value: The number.
        description: Unit and range in words.
    """

    index: int
    value: Fixed
    description: str


@dataclass(frozen=True)
class VariableFieldClass:
    """The class of a variable field: an index and a number.

    Attributes:
        name: Name of the class.
        path: Full name.
        summary: First line of the docstring.
        python_type: Type of the number.
        alternatives: What may be chosen.
    """

    kind: ClassVar[str] = "variable_field"
    name: str
    path: str
    summary: str
    python_type: str
    alternatives: tuple[Alternative, ...]

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        return 1 + min(alternative.value.size for alternative in self.alternatives)

    @property
    def default(self) -> str:
        """Default number."""
        return self.alternatives[0].value.default

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class.

        Args:
            column: Column at which it will stand.
        """
        return docs.docstring(self.summary, column, (), self.attributes)

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """Names and descriptions for the docstring."""
        choices = "; ".join(f"{a.index}: {a.description}" for a in self.alternatives)
        return (("index", f"Which type and unit: {choices}."), ("value", "The number."))

    @property
    def refusal(self) -> Call:
        """The error for an index that names no type."""
        return Call("DecodeError", (f'"{self.path}"', 'f"index {index} names no type"'))

    @property
    def is_complex(self) -> bool:
        """Whether its methods have more branches than the style allows without a word."""
        return len(self.alternatives) + 1 > MAXIMUM_COMPLEXITY


@dataclass(frozen=True)
class ContainerClass:
    """A class of members: the message itself or a record or sequence inside it.

    Attributes:
        name: Name of the class.
        path: Full name.
        summary: First line of the docstring.
        paragraphs: What follows in the docstring.
        members: The attributes.
        segments: How they stand on the wire.
        presence_struct: Name of the constant for the presence vector, or empty.
        presence_size: Bytes of the presence vector.
        tag: Position in the variant that it is an option of.
        jaus_name: Name in the model of what it is the class of.
        is_wrapper: Whether it only gives a class to a list, array, variant or single field.
    """

    kind: ClassVar[str] = "container"
    name: str
    path: str
    summary: str
    paragraphs: tuple[str, ...]
    members: tuple[Member, ...]
    segments: tuple[Run | Single, ...]
    presence_struct: str = ""
    presence_size: int = 0
    tag: int | None = None
    jaus_name: str = ""
    is_wrapper: bool = False

    @property
    def min_size(self) -> int:
        """Fewest bytes on the wire."""
        always = (member.value.min_size for member in self.members if not member.is_optional)
        return self.presence_size + sum(always)

    @property
    def presence_mask(self) -> int:
        """The known bits of the presence vector."""
        return sum(member.bit for member in self.members)

    @property
    def has_unknown_bits(self) -> bool:
        """Whether the presence vector has bits that no member uses."""
        return self.presence_mask < 2 ** (8 * self.presence_size) - 1

    @property
    def has_optional(self) -> bool:
        """Whether any member is optional."""
        return self.presence_mask != 0

    def docstring(self, column: int) -> str:
        """Returns the docstring of the class.

        Args:
            column: Column at which it will stand.
        """
        return docs.docstring(self.summary, column, self.paragraphs, self.attributes)

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """Names and descriptions for the docstring."""
        return tuple((member.attribute, member.description) for member in self.members)

    @property
    def arguments(self) -> tuple[Call | str, ...]:
        """Arguments of the constructor after reading."""
        return tuple(member.result for member in self.members)

    @property
    def variants(self) -> tuple[VariantValue, ...]:
        """The variants among its members, in lists and arrays too."""
        values = (getattr(member.value, "element", member.value) for member in self.members)
        return tuple(value for value in values if isinstance(value, VariantValue))

    @property
    def presence_check(self) -> Call:
        """The statement that refuses unknown bits of the presence vector."""
        return Call("check_presence", ("presence", f"0x{self.presence_mask:X}", f'"{self.path}"'))

    @property
    def is_complex(self) -> bool:
        """Whether its methods have more branches than the style allows without a word."""
        branches: int = sum(member.is_optional for member in self.members)
        branches += sum(member.value.kind in ("list", "array") for member in self.members)
        return branches + 1 > MAXIMUM_COMPLEXITY


@dataclass(frozen=True)
class VariantAlias:
    """The union of the classes of a variant.

    Attributes:
        name: Its name in the message class.
        options: Names of the classes.
    """

    kind: ClassVar[str] = "alias"
    name: str
    options: tuple[str, ...]


Part = ContainerClass | VariableFieldClass


@dataclass(frozen=True)
class MessageView:
    """A message as a class.

    Attributes:
        jaus_name: Name in the model.
        code: Message code.
        is_command: Whether it is of the command class.
        body: The class itself.
        nested: Enumerations, parts, bit fields and unions inside it, in the order to write.
        structs: Names and formats of the module's constants that it uses.
        body_name: Name of the record, sequence, list or variant of the body, or empty.
        body_kind: Kind of the body: Record, Sequence, List, Variant or empty.
    """

    jaus_name: str
    code: int
    is_command: bool
    body: ContainerClass
    nested: tuple[
        Enumeration | BitFieldClass | VariableFieldClass | ContainerClass | VariantAlias, ...
    ]
    structs: tuple[tuple[str, str], ...] = ()
    body_name: str = ""
    body_kind: str = ""

    @property
    def class_name(self) -> str:
        """Name of the class."""
        return self.body.name

    @property
    def code_text(self) -> str:
        """Message code as the standard writes it, e.g. `0x4404`."""
        return f"0x{self.code:04X}"

    def find(self, path: str) -> tuple[Member | SubField, ...]:
        """Returns the members along a path of JAUS names, empty when there is none.

        Args:
            path: Names joined by dots, relative to the flattened body, e.g. `TimeStamp.Hour`.
        """
        found: list[Member | SubField] = []
        members: tuple[Member | SubField, ...] = self.body.members
        for name in path.split("."):
            match = [member for member in members if member.jaus_name == name]
            if not match:
                return ()
            found.append(match[0])
            members = tuple(self._inside(match[0]))
        return tuple(found)

    def _inside(self, member: Member | SubField) -> Iterator[Member | SubField]:
        for item in self.nested:
            if isinstance(member, Member) and item.kind != "enumeration":
                if isinstance(item, BitFieldClass) and member.value.python_type == item.path:
                    yield from item.sub_fields
                if isinstance(item, ContainerClass) and member.value.python_type == item.path:
                    yield from item.members


@dataclass(frozen=True)
class MessagesModule:
    """A module of messages.

    Attributes:
        summary: First line of the module's docstring.
        runtime: Package that the codecs are imported from: `.` inside the runtime itself.
        messages: The messages.
        source: Model file.
        element_id: Identity of the model element that the module is of.
    """

    summary: str
    runtime: str
    messages: tuple[MessageView, ...]
    source: str = ""
    element_id: str = ""

    @property
    def structs(self) -> tuple[tuple[str, str], ...]:
        """Names and formats of the module's constants, those of one item first."""
        found = {pair for message in self.messages for pair in message.structs}
        return tuple(sorted(found, key=lambda pair: (len(pair[1]), pair[0])))

    @property
    def layout(self) -> ModuleType:
        """How statements are laid out."""
        return layout

    def has_late_names(self, body: str) -> bool:
        """Whether a default is made by a lambda that only calls a class.

        Args:
            body: The text of the module.
        """
        return "=lambda: " in body

    def head(self, body: str) -> str:
        """Returns the import statements of the module.

        Args:
            body: The text below them, which says what is needed.
        """
        return imports.statements(body, imports.codec_names(self.runtime))
