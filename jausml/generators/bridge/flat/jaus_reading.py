"""Statements that read the wanted values of a JAUS message out of its bytes.

They accept and refuse the same bytes as the codec of the message. Values of fixed size that follow
one another are read by one `struct.Struct`; what nobody wants is stepped over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias

from jausml.generation.literals import python_string
from jausml.generators.bridge.flat.errors import NotFlatError
from jausml.generators.bridge.flat.jaus_blocks import INDENT, Block, Slot
from jausml.generators.bridge.flat.loops import loop_over
from jausml.generators.bridge.flat.pieces import sliced
from jausml.generators.bridge.flat.protocols import Group, Numbers, Octets, Records
from jausml.generators.bridge.flat.vectors import NUMBERS, dtype
from jausml.generators.python.codec.classes import BitFieldClass, ContainerClass, VariableFieldClass
from jausml.generators.python.codec.compounds import ArrayValue, ListValue, PartValue, VariantValue
from jausml.generators.python.codec.scalars import Bits, Blob, Fixed
from jausml.generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.generators.bridge.flat.constants import Constants
    from jausml.generators.python.codec.members import Member
    from jausml.generators.python.codec.messages import MessageView
    from jausml.generators.python.names import Scope

Value: TypeAlias = "Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue"

_STEP = re.compile(r"[^.\[\]]+|\[\d+\]")
_CODE_SIZE = 2
# Presence vector that nobody asks for by its name.
_UNNAMED = "?"


@dataclass
class _Wanted:
    """What is wanted of a value and of what is in it.

    Attributes:
        local: The variable that gets it; empty when it is not wanted itself.
        inner: What is wanted of its members, by attribute, or of its elements, by `[index]`.
        sequence: How it is gone through; None when it is not.
    """

    local: str = ""
    inner: dict[str, _Wanted] = field(default_factory=dict)
    sequence: JausSequence | None = None

    def child(self, step: str) -> _Wanted:
        """Returns what is wanted of a member; nothing when nobody asked."""
        return self.inner.get(step, _Wanted())

    @property
    def indices(self) -> list[int]:
        """The elements that are wanted by themselves."""
        return sorted(int(step[1:-1]) for step in self.inner if step.startswith("["))

    def locals(self) -> list[str]:
        """Returns the variables of it and all in it."""
        own = [self.local] if self.local else []
        if self.sequence is not None:
            own.append(self.sequence.count)
        return own + [name for each in self.inner.values() for name in each.locals()]


@dataclass(frozen=True)
class _Surroundings:
    """What all readings of a message share.

    Attributes:
        message: The message.
        scope: The names of the function.
        constants: The constants of the module.
        data: The variable of the bytes.
        bits: The classes of bit fields by path.
    """

    message: MessageView
    scope: Scope
    constants: Constants
    data: str
    bits: dict[str, BitFieldClass]


class PartReading:
    """What a message and an element of a list have in common.

    Args:
        around: What all readings of the message share.
        value: What is read; None for the body of the message.
        name: What a value that has no name of its own is called.
    """

    def __init__(self, around: _Surroundings, value: Value | None, name: str) -> None:
        self._around = around
        self._value = value
        self._name = name
        self._wanted = _Wanted()

    def value(self, path: str) -> str:
        """Asks for a value; returns the local variable that has it after `lines`.

        The value of a bit field is the integer of its bits, of a variant its tag, of an optional
        part True. What is absent, of an option that was not sent, or behind the end of a list, is
        None.

        Args:
            path: Attributes joined by dots, `[i]` behind one for an element; `.` for an element
                itself.

        Raises:
            NotFlatError: The path leads to no single value.
        """
        wanted = self._find(path)
        if all(isinstance(each, ListValue | ArrayValue) for each in self._at(path)):
            raise NotFlatError(f"{path} is no single value")
        if not wanted.local:
            wanted.local = self._around.scope.claim(self._word(path))
        return wanted.local

    def is_bit_field(self, path: str) -> bool:
        """Tells whether a path leads to a whole bit field."""
        return any(isinstance(each, Bits) for each in self._at(path))

    def sequence(self, path: str) -> JausSequence:
        """Asks for a list or array.

        Args:
            path: Attributes joined by dots.

        Raises:
            NotFlatError: The path leads to no list.
        """
        wanted = self._find(path)
        if wanted.sequence is None:
            found = [v for v in self._at(path) if isinstance(v, ListValue | ArrayValue)]
            if len(found) != 1:
                raise NotFlatError(f"{path} is no list")
            wanted.sequence = JausSequence(self._around, found[0], self._word(path))
        return wanted.sequence

    def chosen(self, path: str, class_name: str) -> str:
        """Asks for an option of a variant; returns the condition that it was sent.

        Args:
            path: The variant.
            class_name: Class of the option in the codec, e.g. `ReportPath.PlannedLocalPath`.

        Raises:
            NotFlatError: The path leads to no such variant.
        """
        for value in self._at(path):
            if isinstance(value, VariantValue):
                tags = [o.python_type for o in value.options]
                if class_name in tags:
                    return f"{self.value(path)} == {tags.index(class_name)}"
        raise NotFlatError(f"{path} is no variant with {class_name}")

    @staticmethod
    def _word(path: str) -> str:
        *_, last = [step for step in _STEP.findall(path) if not step.startswith("[")] or [""]
        index = path.rpartition("[")[2].rstrip("]") if path.endswith("]") else ""
        return "_".join(filter(None, [last or "item", index]))

    def _find(self, path: str) -> _Wanted:
        if not self._at(path):
            raise NotFlatError(f"{self._around.message.jaus_name} has no {path}")
        wanted = self._wanted
        for step in [] if path in {"", "."} else _STEP.findall(path):
            wanted = wanted.inner.setdefault(step, _Wanted())
        return wanted

    def _at(self, path: str) -> list[object]:
        """Returns the values that a path leads to: one in each option that has it."""
        found: list[object] = [self._value or self._around.message.body]
        for step in [] if path in {"", "."} else _STEP.findall(path):
            found = [inner for each in found for inner in self._inside(each, step)]
        return found

    def _inside(self, value: object, step: str) -> list[object]:
        if step.startswith("["):
            if isinstance(value, ListValue):
                return [value.element]
            is_there = isinstance(value, ArrayValue) and int(step[1:-1]) < value.count
            return [value.element] if is_there and isinstance(value, ArrayValue) else []
        if isinstance(value, VariantValue):
            return [each for o in value.options for each in self._inside(o.part, step)]
        if isinstance(value, PartValue):
            return self._inside(value.part, step)
        if isinstance(value, ContainerClass):
            return [m.value for m in value.members if m.attribute == step]
        if isinstance(value, VariableFieldClass):
            return [value] if step in {"index", "value"} else []
        if isinstance(value, Bits):
            subs = self._around.bits[value.python_type].sub_fields
            return [sub.value for sub in subs if sub.attribute == step]
        return []


class JausReading(PartReading):
    """Reads a JAUS message.

    Args:
        message: The message.
        constants: The constants of the module.
        scope: The names of the function.
        data: The variable of the bytes: message code and body.
    """

    def __init__(
        self, message: MessageView, constants: Constants, scope: Scope, data: str = "data"
    ) -> None:
        bits = {item.path: item for item in message.nested if isinstance(item, BitFieldClass)}
        super().__init__(_Surroundings(message, scope, constants, data, bits), None, "")

    def lines(self) -> list[str]:
        """Returns the statements that load all that was asked for."""
        around = self._around
        name = python_string(around.message.jaus_name)
        walk = _Walk(around, "", _CODE_SIZE)
        walk.container(around.message.body, self._wanted)
        if walk.is_one_block:
            walk.flush(is_whole=True)
            ends: list[str] = []
        else:
            walk.flush()
            end = walk.at
            follow = f'f"{{len({around.data}) - {end}}} bytes follow the body"'
            ends = [
                f"if {end} != len({around.data}):",
                f"{INDENT}raise DecodeError({name}, {follow})",
            ]
        if not walk.may_fail:
            return [*walk.lines, *ends]
        return [
            "try:",
            *indented(walk.lines),
            "except struct.error as error:",
            f'{INDENT}raise DecodeError({name}, f"the body ends too early: {{error}}") from None',
            *ends,
        ]


class JausSequence:
    """Reads a list or array of a JAUS message.

    Attributes:
        count: The variable of the number of elements; None where the list is absent.
        element: Reads one element.
        value: The list.
        begin: The variable of where the first element stands.
        end: The variable of where the last element ends.
        rows: The variable of the values of each element, where one layout after a presence vector
            has them all; empty for other elements.
        row: That layout.
        kind: The constant of their types as records; empty where no array has them.
        uses_begin: Whether the first of these was used.
        uses_end: Whether the second was.
    """

    def __init__(self, around: _Surroundings, value: ListValue | ArrayValue, name: str) -> None:
        self._around = around
        self.value = value
        self.count = around.scope.claim(f"{name}_count")
        self.begin = around.scope.claim(f"{name}_begin")
        self.end = around.scope.claim(f"{name}_end")
        self.rows = ""
        self.row: Block | None = None
        self._block: Block | None = None
        self.kind = ""
        self.uses_begin = False
        self.uses_end = False
        self.element = _Element(around, value.element, name)

    def loop(self, body: Sequence[str], index: str = "", most: str = "") -> list[str]:
        """Returns the loop over the elements; asked for before the lines of the message.

        Args:
            body: What is done with each.
            index: A variable that gets the position of the element; empty for none.
            most: Variable of the number of elements that are gone through; empty for all.
        """
        around = self._around
        element = self.element.wanted
        position = index or "_"
        block = self._fixed()
        if block is not None:
            self.uses_begin, self.uses_end = True, self.uses_end or not most
            layout = block.layout(around.constants)
            end = f"{self.begin} + {block.size} * {most}" if most else self.end
            part = f"{self.begin} : {end}" if most else f"{self.begin}:{end}"
            rows = f"{layout}.iter_unpack({around.data}[{part}])"
            return self._loop(rows, block, index, body)
        block = None if most else self._rows()
        if block is not None:
            return self._loop(self.rows, block, index, body)
        offset = around.scope.claim("offset")
        walk = _Walk(around, offset, 0, is_checked=True)
        walk.value(self.value.element, element, self.element.name)
        walk.settle()
        reads = walk.lines if element.locals() else []
        self.uses_begin = self.uses_begin or bool(reads)
        start = [f"{offset} = {self.begin}"] if reads else []
        loop = f"for {position} in range({most or self.count}):"
        return [*start, loop, *indented([*reads, *body])]

    def _fixed(self) -> Block | None:
        """Returns an element as a block of fixed size; None where it is none."""
        if self._block is None:
            self._block = fixed_block(self._around, self.value.element, self.element.wanted)
        return self._block if self._block is not None and self._block.targets else None

    def _rows(self) -> Block | None:
        """Returns an element as a block after a presence vector, which is read before the loop."""
        if self.row is None:
            block = one_block(self._around, self.value.element, self.element.wanted)
            if block is None or block.vector != 0 or not block.targets:
                return None
            self.row = block
            self.rows = self._around.scope.claim(f"{self.element.name}_rows")
        return self.row

    @property
    def asked(self) -> list[str]:
        """Local variables of the values that were asked for."""
        return self.element.wanted.locals()

    def records(self) -> Records:
        """Returns the elements as columns of those values that a loop asked for."""
        constants, scope = self._around.constants, self._around.scope
        fixed = self._fixed()
        block = fixed or self._rows()
        if block is None:
            raise NotFlatError("elements differ from one to the next")
        slots = [slot for slot in block.slots if slot.local]
        names = tuple_of(*(python_string(slot.local) for slot in slots))
        wanted = [slot for slot in slots if block.vector is None or slot is not block.slots[0]]
        if any(slot.then or slot.format not in NUMBERS for slot in slots):
            raise NotFlatError("elements have more than numbers")
        if fixed is None:
            texts = (python_string(slot.local) for slot in slots)
            value = call("PresenceRecords", block.layout(constants), *texts)
            self.kind = constants.named("_RECORDS", value)
            listed = (
                f"if not isinstance({self.rows}, list):",
                f"{INDENT}{self.rows} = {self.rows}.tolist()",
            )
            test = f"not isinstance({self.rows}, list)"
            return Records(test, (), _groups(wanted, self.rows), listed)
        self.uses_begin = True
        kind = constants.named("_RECORD", f"record({block.layout(constants)}, {names})")
        records = scope.claim("records")
        place = f"{self._around.data}, {kind}, {self.count}, {self.begin}"
        line = f"{records} = numpy.frombuffer({place})"
        return Records(f"{self.count} >= LEAST", (line,), _groups(wanted, records))

    def _loop(self, rows: str, block: Block, index: str, body: Sequence[str]) -> list[str]:
        values = block.values()
        changes = bool(values)
        head = loop_over(rows, block.targets, index, self._around.scope, changes=changes)
        return [*head, *indented([*values, *body])]

    def values(self) -> str:
        """Returns the expression of a list of all elements.

        Raises:
            NotFlatError: The elements are no numbers.
        """
        element = self.value.element
        if not isinstance(element, Fixed) or isinstance(element, Bits):
            raise NotFlatError("elements are no numbers")
        self.uses_begin = self.uses_end = True
        layout = self._around.constants.struct(f"<{element.format}")
        items = f"{layout}.iter_unpack({self._around.data}[{self.begin}:{self.end}])"
        return f"[{unpacked(element, 'each[0]')} for each in {items}]"

    def octets(self) -> Octets:
        """Returns the list as bytes, when its elements are numbers of one octet each.

        Raises:
            NotFlatError: They are not.
        """
        found = self.plain_octets
        if found is None:
            raise NotFlatError("elements are no octets")
        self.uses_begin = self.uses_end = True
        return found

    @property
    def plain_octets(self) -> Octets | None:
        """What `octets` would return, which is not asked for yet; None where it refuses."""
        path = octet_of(self.value.element)
        if path is None:
            return None
        return Octets(f"{self._around.data}[{self.begin}:{self.end}]", path, is_signed=False)

    def numbers(self) -> Numbers:
        """Returns what the elements are, when they are real numbers.

        Raises:
            NotFlatError: They are not.
        """
        path, element = number_of(self.value.element)
        return Numbers(path, element.format, element.unpack("{}"))

    def array(self) -> str:
        """Returns the expression of an array of numpy with what stands in the bytes."""
        _, element = number_of(self.value.element)
        self.uses_begin = True
        place = f"{self.count}, {self.begin}"
        return f"numpy.frombuffer({self._around.data}, {dtype(element.format)}, {place})"

    def vector(self) -> str:
        """Returns the expression of all elements as they stand on the wire, at once.

        It is a byte string where they are bytes, a numpy array of them otherwise.

        Raises:
            NotFlatError: The elements are no numbers.
        """
        element = self.value.element
        if not isinstance(element, Fixed) or element.format.endswith("s"):
            raise NotFlatError("elements are no numbers")
        self.uses_begin = True
        self.uses_end = self.uses_end or element.format == "B"
        if element.format == "B":
            return f"{self._around.data}[{self.begin}:{self.end}]"
        kind = {"b": "i", "h": "i", "i": "i", "q": "i", "f": "f", "d": "f"}.get(element.format, "u")
        dtype = python_string(f"<{kind}{element.size}")
        return f"numpy.frombuffer({self._around.data}, {dtype}, {self.count}, {self.begin})"


def _groups(slots: Sequence[Slot], records: str) -> tuple[Group, ...]:
    """Returns values as columns of records, by what is made of them."""
    found: dict[str, tuple[tuple[str, str], ...]] = {}
    for slot in slots:
        value = re.sub(rf"\b{slot.local}\b", "{}", slot.value or slot.local)
        column = slot.local, f"{records}[{python_string(slot.local)}]"
        found[value] = (*found.get(value, ()), column)
    return tuple(Group(columns, value) for value, columns in found.items())


def octet_of(element: object) -> str | None:
    """Returns the path of the number in an element that is one octet, None for other elements.

    Args:
        element: Layout of the elements of a list.
    """
    path = ""
    if isinstance(element, PartValue) and isinstance(element.part, ContainerClass):
        part = element.part
        if len(part.members) != 1 or part.presence_size or part.members[0].is_optional:
            return None
        path, element = part.members[0].attribute, part.members[0].value
    is_octet = isinstance(element, Fixed) and element.format == "B" and element.is_plain
    return path if is_octet and not isinstance(element, Bits) else None


def number_of(element: object) -> tuple[str, Fixed]:
    """Returns the path of the real number in an element that is one, and its layout.

    Args:
        element: Layout of the elements of a list.

    Raises:
        NotFlatError: It is another element.
    """
    path = ""
    if isinstance(element, PartValue) and isinstance(element.part, ContainerClass):
        part = element.part
        if len(part.members) == 1 and not part.presence_size and not part.members[0].is_optional:
            path, element = part.members[0].attribute, part.members[0].value
    if not isinstance(element, Fixed) or isinstance(element, Bits):
        raise NotFlatError("elements are no numbers")
    is_scaled = (
        element.check == "scaled" and not element.reader and element.format in {"B", "H", "I"}
    )
    if not is_scaled and (element.check != "real" or element.format not in {"f", "d"}):
        raise NotFlatError("elements are no real numbers")
    return path, element


class _Element(PartReading):
    """Reads an element of a list; its statements stand in the loop."""

    @property
    def wanted(self) -> _Wanted:
        """What is wanted of it."""
        return self._wanted

    @property
    def name(self) -> str:
        """What an element without a name is called."""
        return self._name

    def lines(self) -> list[str]:
        """Returns nothing: the loop of the list reads its elements."""
        return []


def indented(lines: Iterable[str]) -> list[str]:
    """Returns lines one step further to the right."""
    return [INDENT + line for line in lines]


def fixed_block(around: _Surroundings, value: Value, wanted: _Wanted) -> Block | None:
    """Returns a value as one block of fixed size; None when it is none.

    Args:
        around: What all readings of the message share.
        value: The value.
        wanted: What is wanted of it.
    """
    block = one_block(around, value, wanted)
    return block if block is not None and block.is_fixed else None


def one_block(around: _Surroundings, value: Value, wanted: _Wanted) -> Block | None:
    """Returns a value as one block; None when it is none.

    Args:
        around: What all readings of the message share.
        value: The value.
        wanted: What is wanted of it.
    """
    walk = _Walk(around, "offset", 0)
    walk.value(value, wanted, "item")
    return walk.block if walk.is_one_block else None


class _Walk:
    """Writes the statements that read values in the order of the wire.

    Args:
        around: What all readings of the message share.
        offset: The variable of the present place; empty before there is one.
        known: Where it starts from that variable.
        is_checked: Whether the same bytes were read before, so that counts are right.
    """

    def __init__(
        self, around: _Surroundings, offset: str, known: int, *, is_checked: bool = False
    ) -> None:
        self._is_checked = is_checked
        self._around = around
        self._offset = offset
        self._known = known
        self._start = known
        self._has_flushed = False
        self.block = Block()
        self.lines: list[str] = []
        self.may_fail = False

    # -- places ----------------------------------------------------------------------------------

    @property
    def is_one_block(self) -> bool:
        """Whether all that was read is in the present block."""
        return not self._has_flushed and not self.lines

    @property
    def at(self) -> str:
        """The present place, as Python text."""
        return self._behind(0)

    def _behind(self, size: int) -> str:
        known = self._known + size
        if not self._offset:
            return str(known)
        return f"{self._offset} + {known}" if known else self._offset

    def settle(self) -> None:
        """Brings the variable of the present place up to date."""
        self.flush()
        if self._known or not self._offset:
            self._move("")

    def _move(self, by: str) -> None:
        """Moves the present place by a size that is known at run time."""
        target = self._offset or self._around.scope.claim("offset")
        if self._offset and not self._known and by:
            self.lines.append(f"{target} += {by}")
        else:
            self.lines.append(f"{target} = {self.at} + {by}" if by else f"{target} = {self.at}")
        self._offset, self._known = target, 0

    # -- blocks ----------------------------------------------------------------------------------

    def flush(self, *, is_whole: bool = False) -> None:
        """Writes the statements that read the present block.

        Args:
            is_whole: Whether it is the whole message, which then has no more bytes.
        """
        block, self.block = self.block, Block()
        if not block.slots and not is_whole:
            return
        self._has_flushed = True
        data, constants = self._around.data, self._around.constants
        if block.is_fixed:
            if is_whole:
                self._unpack(block, block.layout(constants, self._known), f"unpack({data})")
            elif block.targets:
                self._unpack(block, block.layout(constants), f"unpack_from({data}, {self.at})")
            self._known += block.size
            return
        layouts = block.layout(constants, self._known if is_whole else 0)
        key = block.presence
        if block.vector is not None:
            size = block.slots[block.vector].size
            begin, end = self._behind(block.before), self._behind(block.before + size)
            key = sliced(data, begin, end)
        else:
            key = f"{key} & 0x{block.bits:X}"
        if is_whole:
            self._unpack(block, f"{layouts}[{key}]", f"unpack({data})")
            return
        if block.targets:
            layout = self._around.scope.claim("layout")
            self.lines.append(f"{layout} = {layouts}[{key}]")
            self._unpack(block, layout, f"unpack_from({data}, {self.at})")
            self._move(f"{layout}.size")
        else:
            self._move(f"{layouts}[{key}].size")

    def _unpack(self, block: Block, layout: str, unpack: str) -> None:
        self.may_fail = True
        targets = f"{block.targets} = " if block.targets else ""
        self.lines += [f"{targets}{layout}.{unpack}", *block.values()]

    def _add(self, slot: Slot) -> None:
        self.block.slots.append(slot)

    # -- containers ------------------------------------------------------------------------------

    def container(self, part: ContainerClass, wanted: _Wanted) -> None:
        """Reads the members of a message or part.

        Args:
            part: The message or part.
            wanted: What is wanted of it.
        """
        presence = ""
        if part.presence_size:
            if self.block.presence:
                self.flush()
            presence = self._presence(part, wanted)
        for member in part.members:
            inner = wanted.child(member.attribute)
            if member.is_optional:
                self._optional(member, inner, presence)
            else:
                self.value(member.value, inner, member.attribute)

    def _presence(self, part: ContainerClass, wanted: _Wanted) -> str:
        """Begins the fields after a presence vector; returns its variable."""
        is_used = any(
            member.is_optional
            and (wanted.child(member.attribute).locals() or not isinstance(member.value, Fixed))
            for member in part.members
        )
        first = next(
            (i for i, m in enumerate(part.members) if not isinstance(m.value, Fixed)), None
        )
        late = first is not None and any(m.is_optional for m in part.members[first:])
        name = self._around.scope.claim("presence") if is_used or late else ""
        struct_format = {1: "B", 2: "H", 4: "I", 8: "Q"}[part.presence_size]
        self.block.where = part.path
        self.block.vector = len(self.block.slots)
        self.block.presence = name or _UNNAMED
        self.block.known = (
            part.presence_mask if part.has_unknown_bits else (1 << 8 * part.presence_size) - 1
        )
        self._add(Slot(struct_format, name))
        return name

    def _optional(self, member: Member, wanted: _Wanted, presence: str) -> None:
        """Reads a member that may be absent."""
        value = member.value
        if isinstance(value, Fixed):
            if not self.block.presence:
                self.block.presence = presence
            elif presence and self.block.presence != presence:
                self.flush()
                self.block.presence = presence
            self.fixed(value, wanted, member.attribute, member.bit)
            return
        self.settle()
        self.lines += self._absent(wanted)
        self.lines.append(f"if {presence} & 0x{member.bit:X}:")
        inner = self._deeper()
        inner.value(value, wanted, member.attribute)
        self._take(inner)

    def _absent(self, wanted: _Wanted) -> list[str]:
        return [f"{name} = None" for name in wanted.locals()]

    def _deeper(self) -> _Walk:
        """Returns the walk through a block of statements in the present one."""
        return _Walk(self._around, self._offset, 0, is_checked=self._is_checked)

    def _take(self, inner: _Walk) -> None:
        """Takes over the statements of a block."""
        inner.settle()
        self.may_fail |= inner.may_fail
        self.lines += indented(inner.lines or ["pass"])

    # -- values ----------------------------------------------------------------------------------

    def value(self, value: Value, wanted: _Wanted, name: str) -> None:
        """Reads a value.

        Args:
            value: The value.
            wanted: What is wanted of it.
            name: Attribute that errors name.
        """
        if wanted.local and isinstance(value, PartValue):
            self.lines.append(f"{wanted.local} = True")
        match value:
            case Fixed():
                self.fixed(value, wanted, name)
            case Blob():
                self._blob(value, wanted, name)
            case PartValue() if isinstance(value.part, ContainerClass):
                self.container(value.part, wanted)
            case PartValue() if isinstance(value.part, VariableFieldClass):
                self._variable(value.part, wanted)
            case VariantValue():
                self._variant(value, wanted)
            case ListValue():
                self._list(value, wanted, name)
            case ArrayValue():
                self._array(value, wanted, name)

    def fixed(self, value: Fixed, wanted: _Wanted, name: str, bit: int = 0) -> None:
        """Reads a value of fixed size, in the present block."""
        if isinstance(value, Bits):
            self._bits(value, wanted, name, bit)
            return
        local = wanted.local
        self._add(Slot(value.format, local, bit, unpacked(value, local)))

    def _bits(self, value: Bits, wanted: _Wanted, name: str, bit: int) -> None:
        subs = {s.attribute: s for s in self._around.bits[value.python_type].sub_fields}
        local = wanted.local
        if wanted.inner and not local:
            local = wanted.local = self._around.scope.claim(f"{name}_bits")
        then = []
        for attribute, inner in wanted.inner.items():
            code = re.sub(r"\bbits\b", local, subs[attribute].extracted)
            absent = f" if {local} is not None else None" if bit else ""
            then.append(f"{inner.local} = {code}{absent}")
        self._add(Slot(value.format, local, bit, local, tuple(then)))

    def _blob(self, value: Blob, wanted: _Wanted, name: str) -> None:
        size = self._count(value.count_format, "size")
        label = python_string(name)
        self._check(size, value.upper, value.count_size, label, "length")
        begin, data = self.at, self._around.data
        end = f"{begin} + {size}"
        self._room(f"{end}", label, f"length {{{size}}} is more than what follows")
        if wanted.local:
            decoded = '.decode("latin-1")' if value.is_text else ""
            self.lines.append(f"{wanted.local} = {sliced(data, begin, end)}{decoded}")
        self._move(size)

    def _count(self, struct_format: str, name: str, local: str = "") -> str:
        """Reads a count or tag, with what stands before it."""
        local = local or self._around.scope.claim(name)
        self._add(Slot(struct_format, local))
        self.flush()
        return local

    def _check(self, size: str, upper: int, count_size: int, label: str, what: str) -> None:
        """Checks a count that its format does not limit."""
        if not self._is_checked and upper < (1 << 8 * count_size) - 1:
            self.lines += [
                f"if {size} > {upper}:",
                f'{INDENT}raise DecodeError({label}, f"{what} {{{size}}} is more than {upper}")',
            ]

    def _room(self, end: str, label: str, what: str) -> None:
        """Checks that there are as many bytes as were announced."""
        if not self._is_checked:
            self.lines += [
                f"if {end} > len({self._around.data}):",
                f'{INDENT}raise DecodeError({label}, f"{what}")',
            ]

    def _variable(self, part: VariableFieldClass, wanted: _Wanted) -> None:
        index = self._count("B", "index", wanted.child("index").local)
        local = wanted.child("value").local
        self.settle()
        inners = []
        for each in part.alternatives:
            inner = self._deeper()
            inner.fixed(each.value, _Wanted(local), "value")
            inners.append((each.index, inner))
        self._choose(index, inners, part.path, f"index {{{index}}} names no type")

    def _choose(self, choice: str, inners: list[tuple[int, _Walk]], where: str, no: str) -> None:
        """Writes the statements of the choice that was sent, those that are alike once."""
        bodies: dict[tuple[str, ...], list[int]] = {}
        for number, inner in inners:
            inner.settle()
            self.may_fail |= inner.may_fail
            bodies.setdefault(tuple(inner.lines) or ("pass",), []).append(number)
        word = "if"
        for body, numbers in bodies.items():
            test = f"== {numbers[0]}" if len(numbers) == 1 else f"in {tuple(numbers)}"
            self.lines += [f"{word} {choice} {test}:", *indented(body)]
            word = "elif"
        self.lines += ["else:", f'{INDENT}raise DecodeError({python_string(where)}, f"{no}")']

    def _variant(self, value: VariantValue, wanted: _Wanted) -> None:
        self.lines += self._absent(_Wanted("", wanted.inner))
        tag = self._count(value.tag_format, "tag", wanted.local)
        self.settle()
        inners = []
        for position, option in enumerate(value.options):
            inner = self._deeper()
            of_option = {
                member.attribute: wanted.inner[member.attribute]
                for member in getattr(option.part, "members", ())
                if member.attribute in wanted.inner
            }
            inner.value(option, _Wanted("", of_option), "")
            inners.append((position, inner))
        self._choose(tag, inners, value.python_type, f"tag {{{tag}}} names no option")

    # -- lists -----------------------------------------------------------------------------------

    def _list(self, value: ListValue, wanted: _Wanted, name: str) -> None:
        sequence = wanted.sequence
        count = self._count(value.count_format, "count", sequence.count if sequence else "")
        self._check(count, value.upper, value.count_size, python_string(name), "count")
        end = f"{self.at} + {count} * {value.element_size}"
        self._room(end, python_string(name), f"count {{{count}}} needs more than follows")
        self._elements(value, wanted, count)

    def _array(self, value: ArrayValue, wanted: _Wanted, name: str) -> None:
        if isinstance(value.element, Fixed) and wanted.sequence is None:
            for index in range(value.count):
                self.fixed(value.element, wanted.child(f"[{index}]"), f"{name}_{index}")
            return
        self.flush()
        count = str(value.count)
        if wanted.sequence is not None:
            self.lines.append(f"{wanted.sequence.count} = {count}")
        self._elements(value, wanted, count)

    def _elements(self, value: ListValue | ArrayValue, wanted: _Wanted, count: str) -> None:
        """Reads the elements that are wanted by themselves, and steps over all."""
        self.settle()
        sequence = wanted.sequence
        if sequence is not None and sequence.uses_begin:
            self.lines.append(f"{sequence.begin} = {self.at}")
        if wanted.indices:
            self._indexed(value, wanted, count)
        probed = replace(self._around, scope=self._around.scope.copy())
        block = one_block(probed, value.element, _Wanted())
        if block is not None and block.is_fixed:
            self._move(f"{count} * {block.size}" if block.size != 1 else count)
        elif sequence is not None and sequence.row is not None:
            self._rows(sequence, sequence.row, count)
        elif block is not None and block.vector == 0:
            layouts = block.layout(self._around.constants)
            place = f"{self._around.data}, {self._offset}, {count}"
            self.lines.append(f"{self._offset} = {layouts}.behind({place})")
        else:
            inner = self._deeper()
            inner.value(value.element, _Wanted(), "item")
            self.lines.append(f"for _ in range({count}):")
            self._take(inner)
        if sequence is not None and sequence.uses_end:
            self.lines.append(f"{sequence.end} = {self.at}")

    def _rows(self, sequence: JausSequence, block: Block, count: str) -> None:
        """Reads elements with a presence vector, at once where all have the same."""
        self.may_fail = True
        layouts = sequence.kind or block.layout(self._around.constants)
        place = f"{self._around.data}, {self._offset}, {count}"
        self.lines.append(f"{sequence.rows}, {self._offset} = {layouts}.rows({place})")

    def _indexed(self, value: ListValue | ArrayValue, wanted: _Wanted, count: str) -> None:
        """Reads the elements that are wanted by their index, from the first on."""
        names = [name for inner in wanted.inner.values() for name in inner.locals()]
        self.lines += [f"{name} = None" for name in names]
        offset = self._around.scope.claim("offset")
        lines = [f"{offset} = {self.at}"]
        margin = ""
        for index in range(wanted.indices[-1] + 1):
            if isinstance(value, ListValue):
                lines.append(f"{margin}if {count} > {index}:")
                margin += INDENT
            inner = _Walk(self._around, offset, 0, is_checked=self._is_checked)
            inner.value(value.element, wanted.child(f"[{index}]"), "item")
            inner.settle()
            self.may_fail |= inner.may_fail
            lines += [margin + line for line in inner.lines]
        self.lines += lines


def unpacked(value: Fixed, raw: str) -> str:
    """Returns the value of what stood on the wire, as Python text."""
    if value.reader == "unpadded":
        return f'{raw}.split(b"\\0", 1)[0].decode("latin-1")'
    return value.unpack(raw)
