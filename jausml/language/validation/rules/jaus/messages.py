"""Rules about message bodies (AS5684)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.jaus.fields import Group, class_name, is_container, is_group
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

Bytes: TypeAlias = "jaus.VariableLengthString | jaus.VariableLengthField | jaus.VariableFormatField"
Indexed: TypeAlias = "jaus.Alternative | jaus.Format"

_PRESENCE_BITS = {
    "none": 0,
    **{name: integer_type.bits for name, integer_type in wire.UNSIGNED.items()},
}
_IN_RECORD = "a member of a record"
_COUNT = ("name", "countType")


@rule("JML321", "type refers to itself", kinds=jaus.TypeReference)
def reference_cycle(_: Subject, reference: jaus.TypeReference) -> Iterator[Finding]:
    """A type reference leads to a type that does not hold the reference itself.

    A body that contains itself has no end on the wire.

    Bad: a declared record with a member that refers to that record

    Good: a list of a declared record
    """
    if _reaches(reference, reference):
        yield Finding(reference, f"'{reference.name}' contains itself", "target")


@rule("JML322", "wrong kind of member", kinds=jaus.MessageDef)
def member_kinds(_: Subject, message: jaus.MessageDef) -> Iterator[Finding]:
    """Records and arrays hold fields; bodies, sequences, lists and variants hold containers.

    Containers are records, lists, variants and sequences (AS5684, JSIDL). A container inside a
    record is an information only: the bytes are those of a sequence with records in turn, but JSIDL
    cannot express it like this.

    Bad: a sequence with a FixedField as its member

    Good: a sequence with a record that holds the FixedField
    """
    yield from _kind_findings([message.body], "the body of a message", containers=True)


_ROLES = {
    "Record": (_IN_RECORD, False),
    "Sequence": ("a member of a sequence", True),
    "List": ("the element of a list", True),
    "Variant": ("an option of a variant", True),
    "Array": ("the element of an array", False),
}
"""The names of members, and whether they are containers, by the class of their owner."""


@member_kinds.also((jaus.Record, jaus.Sequence, jaus.List, jaus.Variant, jaus.Array))
def _inner_kinds(_: Subject, field: jaus.Field) -> Iterator[Finding]:
    role, containers = _ROLES[class_name(field)]
    yield from _kind_findings(_parts(field), role, containers=containers)


@rule("JML323", "optional member without a presence bit", kinds=(jaus.Record, jaus.Sequence))
def presence_vector(subject: Subject, group: Group) -> Iterator[Finding]:
    """The presence vector of a record or sequence has a bit for each optional member.

    Bit i stands for the i-th optional member (AS5684, presence_vector). For services of the
    library, which are as they were published, this is a warning: members without a bit
    cannot be sent.

    Bad: `<body xsi:type="jaus:Record" name="rec">` with a member that is `optional="true"`

    Good: the same record with `presenceVector="uint8"`
    """
    optional = [field for field in group.fields if field.optional]
    bits = _PRESENCE_BITS[group.presenceVector.name]
    if len(optional) > bits:
        field = optional[bits]
        have = f"a presence vector of {bits} bits" if bits else "no presence vector"
        message = f"{len(optional)} optional members in '{group.name}', which has {have}"
        note = Note(group, f"'{group.name}'", "presenceVector")
        hint, severity = _vector_hint(len(optional)), subject.severity(field)
        yield Finding(field, message, "optional", hint, (note,), severity)


@rule(
    "JML324",
    "optional without effect",
    severity=Severity.WARNING,
    kinds=jaus.Field,
    needs=("name",),
)
def optional_elsewhere(_: Subject, field: jaus.Field) -> Iterator[Finding]:
    """Only members of records and sequences can be optional.

    Elsewhere no bit on the wire states whether the field is present, so it always is.

    Bad: a list element with `optional="true"`

    Good: a list with `minimumCount="0"`
    """
    owner = field.eContainer()
    if field.optional and owner is not None and not is_group(owner):
        message = f"'{field.name}' is optional, but is no member of a record or sequence"
        yield Finding(field, message, "optional")


@rule("JML326", "impossible bit range", kinds=jaus.BitField)
def bit_ranges(subject: Subject, field: jaus.BitField) -> Iterator[Finding]:
    """The parts of a bit field lie within its unsigned integer and do not overlap.

    Bit 0 is the least significant one; lowBit is at most highBit.

    Bad: parts 0..3 and 3..7 of a uint8

    Good: parts 0..3 and 4..7
    """
    whole = wire.UNSIGNED.get(field.type.name)
    if whole is None:
        message = f"bit field '{field.name}' is of {field.type.name}, no unsigned integer"
        yield Finding(field, message, "type")
        return
    owners: dict[int, jaus.SubField] = {}
    for part in field.subFields:
        if not subject.is_read(part):
            continue
        yield from _bit_findings(part, field, whole.bits, owners)


@rule("JML327", "count or tag of a wrong type", kinds=jaus.List, needs=_COUNT)
def count_types(_: Subject, counted_list: jaus.List) -> Iterator[Finding]:
    """Counts and tags are unsigned integers, and the bounds of a count fit its type.

    Bad: `<element xsi:type="jaus:List" countType="int8" .../>`

    Good: `<element xsi:type="jaus:List" countType="uint8" .../>`
    """
    yield from _count_findings(
        counted_list, "Count", counted_list.minimumCount, counted_list.maximumCount
    )


@count_types.also(
    (jaus.VariableLengthString, jaus.VariableLengthField, jaus.VariableFormatField), needs=_COUNT
)
def _length_types(_: Subject, field: Bytes) -> Iterator[Finding]:
    yield from _count_findings(field, "Length", field.minimumLength, field.maximumLength)


@count_types.also(jaus.Variant)
def _tag_types(_: Subject, variant: jaus.Variant) -> Iterator[Finding]:
    type_name = variant.tagType.name
    if type_name not in wire.UNSIGNED:
        message = f"the tag of '{variant.name}' is of {type_name}, no unsigned integer"
        yield Finding(variant, message, "tagType")
    elif len(variant.options) > wire.UNSIGNED[type_name].upper + 1:
        message = f"the tag of '{variant.name}' cannot count {len(variant.options)} options"
        yield Finding(variant, message, "tagType")


@rule("JML328", "impossible size or index", kinds=jaus.FixedLengthString, needs=("name",))
def sizes(_: Subject, text: jaus.FixedLengthString) -> Iterator[Finding]:
    """Strings and arrays have a size of 1 or more; indices are one byte and differ.

    No more than 4194304 bytes or elements: larger messages are not put together from fragments.

    Bad: `<fields xsi:type="jaus:FixedLengthString" name="id" length="0"/>`

    Good: `length="16"`
    """
    if text.length < 1:
        yield Finding(text, f"'{text.name}' has a length of {text.length}", "length")
    elif text.length > wire.LARGEST:
        message = f"'{text.name}' has a length of {text.length}, more than {wire.LARGEST}"
        yield Finding(text, message, "length")


@sizes.also(jaus.Array, needs=("name",))
def _sizes_array(_: Subject, array: jaus.Array) -> Iterator[Finding]:
    if any(size < 1 for size in array.dimensions):
        yield Finding(array, f"'{array.name}' has a dimension below 1", "dimensions")
    elif math.prod(array.dimensions) > wire.LARGEST:
        message = f"'{array.name}' has more than {wire.LARGEST} elements"
        yield Finding(array, message, "dimensions")


@sizes.also((jaus.VariableField, jaus.VariableFormatField))
def _indices(_: Subject, field: jaus.VariableField | jaus.VariableFormatField) -> Iterator[Finding]:
    choices: Iterable[Indexed] = (
        field.alternatives if isinstance(field, jaus.VariableField) else field.formats
    )
    yield from _index_findings(choices, field)


@rule("JML360", "message beyond all bounds", kinds=jaus.MessageDef)
def bounds(subject: Subject, message: jaus.MessageDef) -> Iterator[Finding]:
    """A message has at most 10000 fields, 64 deep, and its smallest instance 4194304 values.

    A field counts as often as the types that hold it are used, and arrays in arrays multiply: a few
    lines can require more memory than any machine has.

    Bad: an array of 4194304 records that hold an array of 4194304 numbers

    Good: a list of 0 to 4194304 records with a list of numbers
    """
    body = message.body
    if body is None or _is_small(body) or not subject.is_intact(message):
        return
    try:
        wire.resolve_field(body)
    except wire.LimitError as error:
        yield Finding(message, f"'{message.name}' is too large: {error.reason}")
    except wire.LayoutError:
        return  # which other rules tell


def _is_small(body: jaus.Field) -> bool:
    """Tells at a glance that a body is within all bounds: it has few numbers and nothing else."""
    if not is_group(body) or len(body.fields) >= wire.MOST_FIELDS:
        return False
    return all(isinstance(field, jaus.FixedField) for field in body.fields)


def _reaches(reference: jaus.TypeReference, goal: jaus.Field) -> bool:
    pending: list[jaus.Field] = [reference.target]
    seen = set()
    while pending:
        field = pending.pop()
        if field is None or field in seen:
            continue
        if field is goal:
            return True
        seen.add(field)
        pending += [field.target] if isinstance(field, jaus.TypeReference) else _parts(field)
    return False


def _parts(field: jaus.Field) -> list[jaus.Field]:
    if is_group(field):
        return list(field.fields)
    if isinstance(field, jaus.Variant):
        return list(field.options)
    return [field.element] if isinstance(field, (jaus.List, jaus.Array)) else []


def _kind_findings(
    fields: Iterable[jaus.Field | None], role: str, *, containers: bool
) -> Iterator[Finding]:
    for field in fields:
        target = wire.target_of(field)
        if field is None or target is None:
            continue
        if is_container(target) is not containers:
            wanted = "a record, list, variant or sequence" if containers else "a field"
            severity = Severity.INFO if role == _IN_RECORD else None
            message = f"'{field.name}' is a {class_name(target)}, but {role} is {wanted}"
            yield Finding(field, message, severity=severity)


def _vector_hint(count: int) -> str:
    fitting = next((name for name, integer in wire.UNSIGNED.items() if integer.bits >= count), "")
    return f'presenceVector="{fitting}"' if fitting else "split the group"


def _bit_findings(
    part: jaus.SubField, field: jaus.BitField, bits: int, owners: dict[int, jaus.SubField]
) -> Iterator[Finding]:
    if part.lowBit > part.highBit:
        message = f"'{part.name}' has lowBit {part.lowBit} above highBit {part.highBit}"
        yield Finding(part, message, "lowBit")
        return
    if part.lowBit < 0 or part.highBit >= bits:
        message = f"bits {part.lowBit}..{part.highBit} of '{part.name}' are outside"
        yield Finding(part, f"{message} {field.type.name} '{field.name}'", "highBit")
        return
    for bit in range(part.lowBit, part.highBit + 1):
        owner = owners.setdefault(bit, part)
        if owner is not part:
            note = Note(owner, f"'{owner.name}'")
            message = f"bit {bit} of '{part.name}' belongs to '{owner.name}' too"
            yield Finding(part, message, "lowBit", related=(note,))
            return


def _count_findings(field: jaus.List | Bytes, noun: str, low: int, high: int) -> Iterator[Finding]:
    minimum, maximum, type_name = f"minimum{noun}", f"maximum{noun}", field.countType.name
    if type_name not in wire.UNSIGNED:
        message = f"the count of '{field.name}' is of {type_name}, no unsigned integer"
        yield Finding(field, message, "countType")
        return
    largest = wire.UNSIGNED[type_name].upper
    for feature, value in ((minimum, low), (maximum, high)):
        if not 0 <= value <= largest:
            message = f"{feature} {value} of '{field.name}' is not in 0..{largest}"
            yield Finding(field, message, feature)
            return
    if high and low > high:
        message = f"'{field.name}' has {minimum} {low} above {maximum} {high}"
        yield Finding(field, message, minimum)


def _index_findings(choices: Iterable[Indexed], field: jaus.Field) -> Iterator[Finding]:
    seen: dict[int, Indexed] = {}
    largest = 255  # one byte
    for choice in choices:
        first = seen.setdefault(choice.index, choice)
        if not 0 <= choice.index <= largest:
            message = f"index {choice.index} of '{choice.name}' is not in 0..255"
            yield Finding(choice, message, "index")
        elif first is not choice:
            message = f"index {choice.index} in '{field.name}' is that of '{first.name}'"
            yield Finding(choice, message, "index", related=(Note(first, f"'{first.name}'"),))
