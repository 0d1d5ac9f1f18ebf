"""Statements that read values in the order in which a JAUS message has them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.jaus_blocks import INDENT, Block, Slot
from jausml_generators.bridge.flat.jaus_wanted import Elements, Surroundings, Value, Wanted
from jausml_generators.bridge.flat.pieces import sliced
from jausml_generators.python.codec.classes import ContainerClass, VariableFieldClass
from jausml_generators.python.codec.compounds import ArrayValue, ListValue, PartValue, VariantValue
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml_generators.python.codec.members import Member


# Presence vector that nobody asks for by its name.
_UNNAMED = "?"


def indented(lines: Iterable[str]) -> list[str]:
    """Returns lines one step further to the right."""
    return [INDENT + line for line in lines]


def fixed_block(around: Surroundings, value: Value, wanted: Wanted) -> Block | None:
    """Returns a value as one block of fixed size; None when it is none.

    Args:
        around: What all readings of the message share.
        value: The value.
        wanted: What is wanted of it.
    """
    block = one_block(around, value, wanted)
    return block if block is not None and block.is_fixed else None


def one_block(around: Surroundings, value: Value, wanted: Wanted) -> Block | None:
    """Returns a value as one block; None when it is none.

    Args:
        around: What all readings of the message share.
        value: The value.
        wanted: What is wanted of it.
    """
    walk = JausWalk(around, "offset", 0)
    walk.value(value, wanted, "item")
    return walk.block if walk.is_one_block else None


class JausWalk:
    """Writes the statements that read values in the order of the wire.

    Args:
        around: What all readings of the message share.
        offset: The variable of the present place; empty before there is one.
        known: Where it starts from that variable.
        is_checked: Whether the same bytes were read before, so that counts are right.
    """

    def __init__(
        self, around: Surroundings, offset: str, known: int, *, is_checked: bool = False
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

    def container(self, part: ContainerClass, wanted: Wanted) -> None:
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

    def _presence(self, part: ContainerClass, wanted: Wanted) -> str:
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

    def _optional(self, member: Member, wanted: Wanted, presence: str) -> None:
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

    def _absent(self, wanted: Wanted) -> list[str]:
        return [f"{name} = None" for name in wanted.locals()]

    def _deeper(self) -> JausWalk:
        """Returns the walk through a block of statements in the present one."""
        return JausWalk(self._around, self._offset, 0, is_checked=self._is_checked)

    def _take(self, inner: JausWalk) -> None:
        """Takes over the statements of a block."""
        inner.settle()
        self.may_fail |= inner.may_fail
        self.lines += indented(inner.lines or ["pass"])

    # -- values ----------------------------------------------------------------------------------

    def value(self, value: Value, wanted: Wanted, name: str) -> None:
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

    def fixed(self, value: Fixed, wanted: Wanted, name: str, bit: int = 0) -> None:
        """Reads a value of fixed size, in the present block."""
        if isinstance(value, Bits):
            self._bits(value, wanted, name, bit)
            return
        local = wanted.local
        self._add(Slot(value.format, local, bit, unpacked(value, local)))

    def _bits(self, value: Bits, wanted: Wanted, name: str, bit: int) -> None:
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

    def _blob(self, value: Blob, wanted: Wanted, name: str) -> None:
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

    def _variable(self, part: VariableFieldClass, wanted: Wanted) -> None:
        index = self._count("B", "index", wanted.child("index").local)
        local = wanted.child("value").local
        self.settle()
        inners = []
        for each in part.alternatives:
            inner = self._deeper()
            inner.fixed(each.value, Wanted(local), "value")
            inners.append((each.index, inner))
        self._choose(index, inners, part.path, f"index {{{index}}} names no type")

    def _choose(self, choice: str, inners: list[tuple[int, JausWalk]], where: str, no: str) -> None:
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

    def _variant(self, value: VariantValue, wanted: Wanted) -> None:
        self.lines += self._absent(Wanted("", wanted.inner))
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
            inner.value(option, Wanted("", of_option), "")
            inners.append((position, inner))
        self._choose(tag, inners, value.python_type, f"tag {{{tag}}} names no option")

    # -- lists -----------------------------------------------------------------------------------

    def _list(self, value: ListValue, wanted: Wanted, name: str) -> None:
        sequence = wanted.sequence
        count = self._count(value.count_format, "count", sequence.count if sequence else "")
        self._check(count, value.upper, value.count_size, python_string(name), "count")
        end = f"{self.at} + {count} * {value.element_size}"
        self._room(end, python_string(name), f"count {{{count}}} needs more than follows")
        self._elements(value, wanted, count)

    def _array(self, value: ArrayValue, wanted: Wanted, name: str) -> None:
        if isinstance(value.element, Fixed) and wanted.sequence is None:
            for index in range(value.count):
                self.fixed(value.element, wanted.child(f"[{index}]"), f"{name}_{index}")
            return
        self.flush()
        count = str(value.count)
        if wanted.sequence is not None:
            self.lines.append(f"{wanted.sequence.count} = {count}")
        self._elements(value, wanted, count)

    def _elements(self, value: ListValue | ArrayValue, wanted: Wanted, count: str) -> None:
        """Reads the elements that are wanted by themselves, and steps over all."""
        self.settle()
        sequence = wanted.sequence
        if sequence is not None and sequence.uses_begin:
            self.lines.append(f"{sequence.begin} = {self.at}")
        if wanted.indices:
            self._indexed(value, wanted, count)
        probed = replace(self._around, scope=self._around.scope.copy())
        block = one_block(probed, value.element, Wanted())
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
            inner.value(value.element, Wanted(), "item")
            self.lines.append(f"for _ in range({count}):")
            self._take(inner)
        if sequence is not None and sequence.uses_end:
            self.lines.append(f"{sequence.end} = {self.at}")

    def _rows(self, sequence: Elements, block: Block, count: str) -> None:
        """Reads elements with a presence vector, at once where all have the same."""
        self.may_fail = True
        layouts = sequence.kind or block.layout(self._around.constants)
        place = f"{self._around.data}, {self._offset}, {count}"
        self.lines.append(f"{sequence.rows}, {self._offset} = {layouts}.rows({place})")

    def _indexed(self, value: ListValue | ArrayValue, wanted: Wanted, count: str) -> None:
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
            inner = JausWalk(self._around, offset, 0, is_checked=self._is_checked)
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
