"""Statements that read the wanted values of a JAUS message out of its bytes.

They accept and refuse the same bytes as the codec of the message. Values of fixed size that follow
one another are read by one `struct.Struct`; what nobody wants is stepped over.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.jaus_blocks import INDENT, Block, Slot
from jausml_generators.bridge.flat.jaus_elements import number_of, octet_of
from jausml_generators.bridge.flat.jaus_walk import (
    JausWalk,
    fixed_block,
    indented,
    one_block,
    unpacked,
)
from jausml_generators.bridge.flat.jaus_wanted import Surroundings, Value, Wanted
from jausml_generators.bridge.flat.loops import loop_over
from jausml_generators.bridge.flat.protocols import Group, Numbers, Octets, Records
from jausml_generators.bridge.flat.vectors import NUMBERS, dtype
from jausml_generators.python.codec.classes import BitFieldClass, ContainerClass, VariableFieldClass
from jausml_generators.python.codec.compounds import ArrayValue, ListValue, PartValue, VariantValue
from jausml_generators.python.codec.scalars import Bits, Fixed
from jausml_generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.python.codec.messages import MessageView
    from jausml_generators.python.names import Scope


_STEP = re.compile(r"[^.\[\]]+|\[\d+\]")


_CODE_SIZE = 2


class PartReading:
    """What a message and an element of a list have in common.

    Args:
        around: What all readings of the message share.
        value: What is read; None for the body of the message.
        name: What a value that has no name of its own is called.
    """

    def __init__(self, around: Surroundings, value: Value | None, name: str) -> None:
        self._around = around
        self._value = value
        self._name = name
        self._wanted = Wanted()

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
        if isinstance(wanted.sequence, JausSequence):
            return wanted.sequence
        found = [v for v in self._at(path) if isinstance(v, ListValue | ArrayValue)]
        if len(found) != 1:
            raise NotFlatError(f"{path} is no list")
        wanted.sequence = made = JausSequence(self._around, found[0], self._word(path))
        return made

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

    def _find(self, path: str) -> Wanted:
        if not self._at(path):
            raise NotFlatError(f"{self._around.message.jaus_name} has no {path}")
        wanted = self._wanted
        for step in [] if path in {"", "."} else _STEP.findall(path):
            wanted = wanted.inner.setdefault(step, Wanted())
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
            member = value.by_attribute.get(step)
            return [member.value] if member is not None else []
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
        super().__init__(Surroundings(message, scope, constants, data, bits), None, "")

    def lines(self) -> list[str]:
        """Returns the statements that load all that was asked for."""
        around = self._around
        name = python_string(around.message.jaus_name)
        walk = JausWalk(around, "", _CODE_SIZE)
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

    def __init__(self, around: Surroundings, value: ListValue | ArrayValue, name: str) -> None:
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
        walk = JausWalk(around, offset, 0, is_checked=True)
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


class _Element(PartReading):
    """Reads an element of a list; its statements stand in the loop."""

    @property
    def wanted(self) -> Wanted:
        """What is wanted of it."""
        return self._wanted

    @property
    def name(self) -> str:
        """What an element without a name is called."""
        return self._name

    def lines(self) -> list[str]:
        """Returns nothing: the loop of the list reads its elements."""
        return []
