"""Check of the members that a map lists against the known message or type."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import prod

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.notation import Fault
from jausml.language.model.values import nearest, show
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.jaus.fields import attributes, class_name
from jausml.language.semantics.paths.attributes import JausPart, Part
from jausml.language.text.keywords import keyword_of
from jausml.language.text.reading import declared_types
from jausml.language.text.reading.maps import WrittenEnd
from jausml.language.text.tree import End, Member, Span
from jausml.language.wire import target_of

_SIZES = {"fixedArray": True, "boundedSequence": False, "unboundedSequence": False}


@dataclass(frozen=True, slots=True)
class MemberKind:
    """The kind of a member of a known message."""

    word: str
    also: frozenset[str] = frozenset()
    size: declared_types.Size | None = None
    inner: Sequence[Part] | None = None

    def __str__(self) -> str:
        if self.size is None:
            return self.word
        sign = "" if self.size.is_fixed or not self.size.count else "<="
        return f"{self.word} [{sign}{self.size.count or ''}]"


class MemberCheck:
    """Checks listed members."""

    def __init__(self, types: declared_types.Types) -> None:
        self._types = types
        self._faults: list[Fault] = []

    def run(self, ends: Sequence[WrittenEnd]) -> list[Fault]:
        """Returns the faults of ends whose messages or types are known."""
        for written in ends:
            if written.node.obj is None:
                continue
            end = written.end
            built: bridge.AttributeMap = written.node.obj
            members = _members_at(built, is_jaus=end.is_jaus)
            if members is None:
                continue
            self._facts(end, written.node)
            label = f"{'message' if end.is_jaus else 'type'} {end.type.text}"
            self._members(end.members or [], members, label, written.node, 0)
        return self._faults

    def _facts(self, end: End, node: Node) -> None:
        if end.features:
            first = end.features[0]
            message = f"{end.type.text} is known: its {first.name.text} stands in its own model"
            self._report("JML713", first.span, message, "remove the block", node)

    def _members(
        self, listed: Sequence[Member], known: Sequence[Part], label: str, node: Node, depth: int
    ) -> None:
        by_name = {part.name: part for part in known}
        seen: set[str] = set()
        for member in listed:
            if member.name is None:
                continue
            name, span = member.name.text, member.name.span
            field = by_name.get(name)
            if name in seen:
                self._report("JML707", span, f"member {show(name)} is listed twice", "", node)
            elif field is None:
                near = nearest(name, [candidate for candidate in by_name if candidate])
                hint = f"did you mean '{near}'?" if near else f"it has {_some(by_name)}"
                self._report("JML708", span, f"{label} has no member {show(name)}", hint, node)
            else:
                self._member(member, kind_of(field), node, depth)
            seen.add(name)

    def _member(self, member: Member, kind: MemberKind | None, node: Node, depth: int) -> None:
        definition = self._resolved(member)
        if kind is None or definition is None or member.name is None:
            return
        if member.features:
            message = f"member {show(member.name.text)} is known: its facts stand in its own model"
            self._report("JML713", member.features[0].span, message, "remove the block", node)
        # The size may stand at the member or at its named type.
        size = declared_types.size_of(member) or declared_types.size_of(definition)
        if not self._agrees(definition, size, kind):
            shown = declared_types.shown_type(member)
            message = f"member {show(member.name.text)} is {kind}, and not {shown}"
            hint = f"write {kind} {member.name.text}"
            self._report("JML709", member.span, message, hint, node)
        elif isinstance(definition.type, list) and depth < declared_types.DEEPEST:
            label = f"member {show(member.name.text)}"
            self._members(definition.type, kind.inner or [], label, node, depth + 1)

    @staticmethod
    def _agrees(definition: Member, size: declared_types.Size | None, kind: MemberKind) -> bool:
        # A sequence of any length stands for a bounded one too.
        is_any = size == declared_types.ANY and kind.size is not None and not kind.size.is_fixed
        if size != kind.size and not is_any:
            return False
        if isinstance(definition.type, list):
            return kind.inner is not None
        word = declared_types.type_word(definition.type.text)
        text = word.word.replace("/msg/", "/")
        return str(word) in (kind.word, *kind.also) or text in (kind.word, *kind.also)

    def _resolved(self, member: Member) -> Member | None:
        """Returns the member that defines the type of another, or that one itself."""
        seen: set[str] = set()
        named = self._types.named
        while not isinstance(member.type, list) and member.type.text in named:
            if member.type.text in seen:
                return None
            seen.add(member.type.text)
            self._types.used.add(member.type.text)
            member = named[member.type.text]
        return member

    def _report(self, rule: str, span: Span, message: str, hint: str, node: Node) -> None:
        self._faults.append(Fault(rule, message, hint, span.line, span.column, node))


def kind_of(field: Part) -> MemberKind | None:
    """Returns the kind of a member of a JAUS message or a ROS type; None for a dangling one."""
    return _ros_kind(field) if isinstance(field, ros.Field) else _jaus_kind(field)


def _jaus_kind(part: JausPart, above: tuple[JausPart, ...] = ()) -> MemberKind | None:
    field = target_of(part) if isinstance(part, jaus.Field) else part
    # A field that contains itself has no end.
    if field is None or field in above:
        return None
    keyword = keyword_of(class_name(field))
    match field:
        case jaus.List() | jaus.Array():
            return _repeated(field, above)
        case jaus.Record() | jaus.Sequence():
            return MemberKind("struct", frozenset({keyword}), None, field.fields)
        case jaus.Variant():
            return MemberKind("struct", frozenset({keyword}), None, field.options)
        case jaus.VariableLengthString(maximumLength=bound) | jaus.FixedLengthString(length=bound):
            also = {keyword, f"{declared_types.STRING}<={bound}"} if bound else {keyword}
            return MemberKind(declared_types.STRING, frozenset(also))
        case jaus.FixedField():
            # JAUS has no bool: it is an octet.
            is_byte = field.type.name == "uint8"
            return MemberKind(
                field.type.name, frozenset({keyword, *([declared_types.BOOL] if is_byte else [])})
            )
        case jaus.BitField():
            return MemberKind(field.type.name, frozenset({keyword}), None, field.subFields)
    return MemberKind(keyword)


def _repeated(field: jaus.List | jaus.Array, above: tuple[JausPart, ...]) -> MemberKind | None:
    """Returns the kind of a list or an array, None when that of its elements is not known."""
    if field.element is None:
        return None
    inner = _jaus_kind(field.element, (*above, field))
    if inner is None:
        return None
    if isinstance(field, jaus.Array):
        size = declared_types.Size(prod(field.dimensions), is_fixed=True)
    else:
        count = field.maximumCount
        # A list whose bounds are equal is what text calls a fixed size.
        size = declared_types.Size(count, is_fixed=0 < count == field.minimumCount)
        inner = _plain(inner)
    return MemberKind(inner.word, inner.also, size, inner.inner)


def _plain(element: MemberKind) -> MemberKind:
    """Returns the kind of an element of a list: records of one plain value stand for the value."""
    fields = element.inner or ()
    if len(fields) != 1 or fields[0].name != declared_types.VALUE:
        return element
    return kind_of(fields[0]) or element


def _ros_kind(field: ros.Field) -> MemberKind | None:
    kind = field.arrayKind.name
    size = None
    if kind in _SIZES:
        count = 0 if kind == "unboundedSequence" else field.arraySize
        size = declared_types.Size(count, is_fixed=_SIZES[kind])
    if isinstance(field, ros.PrimitiveField):
        word = declared_types.type_word(field.type.name).word
        also = {f"{word}<={field.stringBound}"} if field.stringBound else set()
        return MemberKind(word, frozenset(also), size)
    target = field.messageType if isinstance(field, ros.MessageField) else None
    if target is None:
        return None
    package = target.eContainer()
    full = f"{package.name}/{target.name}" if package is not None else target.name
    return MemberKind(full, frozenset({target.name}), size, target.fields)


def _members_at(built: bridge.AttributeMap, *, is_jaus: bool) -> Sequence[Part] | None:
    """Returns the members where paths of one end of a map begin, None when they are not known."""
    if is_jaus:
        return attributes(built.message) if built.message is not None else None
    return built.type.fields if built.type is not None else None


def _some(names: Iterable[str]) -> str:
    shown = [name for name in names if name]
    more = ", ..." if len(shown) > 8 else ""
    return (", ".join(shown[:8]) or "none") + more
