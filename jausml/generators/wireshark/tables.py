"""Message bodies as plain tables, which the dissector interprets (SAE AS5684)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.generation.errors import GenerationError
from jausml.generation.literals import printable
from jausml.generators.python import names
from jausml.generators.python.codec.fields import length_format, name_of
from jausml.generators.python.codec.nesting import Resolved, resolve
from jausml.model import words

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

Table = dict[Any, Any]

EMBEDDED = "JAUS MESSAGE"
"""The format of bytes that are a message code and a body (AS5684)."""

# What the dissector itself adds below the filter of a field.
_TAKEN = frozenset(("count", "data", "format", "index", "length", "presence", "raw", "tag"))
_EXACT = 2**53  # integers below are exact in the numbers of Lua 5.1 and 5.2


def label(text: str) -> str:
    """Returns a text of the model on one line without control characters, never empty."""
    return " ".join(printable(text).split()) or "unnamed"


def filter_word(name: str) -> str:
    """Returns the part of a display filter for a name, e.g. `request_id` for RequestID."""
    word = words.snake_case(name) or "unnamed"
    return f"n{word}" if word[0].isdigit() else word


class TableBuilder:
    """Builds the table of one message's body.

    Args:
        message: Name of the message, for errors.
        filter_name: What the display filters of its fields begin with.

    Attributes:
        types: Type of each display filter.
    """

    def __init__(self, message: str, filter_name: str) -> None:
        self._message = message
        self._filter = filter_name
        self._open: list[Any] = []
        self.types: dict[str, str] = {}
        self._kinds: dict[str, Callable[[Resolved, str], Table]] = {
            "FixedField": self._number,
            "BitField": self._bits,
            "FixedLengthString": self._fixed_text,
            "VariableLengthString": self._text,
            "VariableLengthField": self._bytes,
            "VariableFormatField": self._format,
            "VariableField": self._choice,
            "Record": self._record,
            "Sequence": self._record,
            "List": self._list,
            "Array": self._array,
            "Variant": self._variant,
        }

    def build(self, body: Any) -> Table:
        """Returns the table of a body; one without members for no body.

        Args:
            body: The Field that is the body, or None.

        Raises:
            GenerationError: The body contains itself or refers to nothing.
        """
        if body is None:
            return {}
        resolved = resolve(body)
        if resolved.kind in ("Record", "Sequence"):
            return self._field(resolved, self._filter)
        word = names.Scope(_TAKEN).claim(filter_word(resolved.name))
        return self._field(resolved, f"{self._filter}.{word}")

    def _field(self, field: Resolved, path: str) -> Table:
        if field.type in self._open:
            raise GenerationError(f"'{field.name}' of {self._message} contains itself")
        self._open.append(field.type)
        table = self._kinds[field.kind](field, path)
        self._open.pop()
        optional = {"optional": True} if field.optional else {}
        return {"name": label(field.name), **optional, "filter": path, **table}

    def _typed(self, path: str, kind: str) -> None:
        self.types[path] = kind

    def _members(self, elements: Iterable[Any], path: str) -> list[Table]:
        scope = names.Scope(_TAKEN)
        fields = [resolve(element) for element in elements]
        return [self._field(f, f"{path}.{scope.claim(filter_word(f.name))}") for f in fields]

    # -- values ----------------------------------------------------------------------------------

    def _number(self, field: Resolved, path: str) -> Table:
        return self._number_table(field.type, path)

    def _number_table(self, element: Any, path: str) -> Table:
        """Returns the table of a FixedField or an Alternative."""
        numeric_type = name_of(element.type)
        table: Table = {"kind": "number", "type": numeric_type}
        if element.scale is not None:
            table["scale"] = [float(element.scale.lower), float(element.scale.upper)]
            self._typed(f"{path}.raw", numeric_type)
        self._typed(path, "double" if element.scale is not None else numeric_type)
        units = label(str(element.units)) if element.units else ""
        return {**table, **({"units": units} if units else {}), **_names(element.values)}

    def _bits(self, field: Resolved, path: str) -> Table:
        numeric_type = name_of(field.type.type)
        self._typed(path, numeric_type)
        scope = names.Scope(_TAKEN)
        parts = []
        for sub in field.type.subFields:
            word = f"{path}.{scope.claim(filter_word(str(sub.name)))}"
            self._typed(word, numeric_type)
            place = {"low": int(sub.lowBit), "high": int(sub.highBit)}
            parts.append(
                {"name": label(str(sub.name)), "filter": word, **place, **_names(sub.values)}
            )
        return {"kind": "bits", "type": numeric_type, "parts": parts}

    def _fixed_text(self, field: Resolved, path: str) -> Table:
        self._typed(path, "string")
        return {"kind": "text", "length": int(field.type.length)}

    def _text(self, field: Resolved, path: str) -> Table:
        self._typed(path, "string")
        return {"kind": "text", "count": self._count(field.type.countType, f"{path}.length")}

    def _bytes(self, field: Resolved, path: str) -> Table:
        self._typed(path, "bytes")
        is_message = str(field.type.format) == EMBEDDED
        count = self._count(field.type.countType, f"{path}.length")
        return {"kind": "bytes", "count": count, **({"is_message": True} if is_message else {})}

    def _format(self, field: Resolved, path: str) -> Table:
        self._typed(f"{path}.format", "uint8")
        self._typed(path, "bytes")
        formats = {int(each.index): label(str(each.name)) for each in field.type.formats}
        count = self._count(field.type.countType, f"{path}.length")
        return {"kind": "bytes", "formats": dict(sorted(formats.items())), "count": count}

    def _choice(self, field: Resolved, path: str) -> Table:
        self._typed(path, "none")
        self._typed(f"{path}.index", "uint8")
        scope = names.Scope(_TAKEN)
        options: Table = {}
        for each in sorted(field.type.alternatives, key=lambda each: int(each.index)):
            word = f"{path}.{scope.claim(filter_word(str(each.name)))}"
            head = {"name": label(str(each.name)), "filter": word}
            options[int(each.index)] = {**head, **self._number_table(each, word)}
        return {"kind": "choice", "options": options}

    # -- containers ------------------------------------------------------------------------------

    def _record(self, field: Resolved, path: str) -> Table:
        self._typed(path, "none")
        presence = name_of(field.type.presenceVector)
        table: Table = {"kind": "record"}
        if presence != "none":
            self._typed(f"{path}.presence", presence)
            table["presence"] = presence
        members = self._members(field.type.fields, path)
        if presence == "none":
            for member in members:
                member.pop("optional", None)  # without a presence vector all members are there
        return {**table, "fields": members}

    def _list(self, field: Resolved, path: str) -> Table:
        self._typed(path, "none")
        count = self._count(field.type.countType, f"{path}.count")
        return {"kind": "list", "count": count, "element": self._element(field, path)}

    def _array(self, field: Resolved, path: str) -> Table:
        self._typed(path, "none")
        sizes = [int(size) for size in field.type.dimensions]
        return {"kind": "array", "sizes": sizes, "element": self._element(field, path)}

    def _element(self, field: Resolved, path: str) -> Table:
        """Returns the table of what is repeated; a record passes its list's filter on."""
        element = resolve(field.type.element)
        if element.kind in ("Record", "Sequence"):
            return self._field(element, path)
        word = names.Scope(_TAKEN).claim(filter_word(element.name))
        return self._field(element, f"{path}.{word}")

    def _variant(self, field: Resolved, path: str) -> Table:
        self._typed(path, "none")
        tag = self._count(field.type.tagType, f"{path}.tag")
        return {"kind": "variant", "tag": tag, "options": self._members(field.type.options, path)}

    def _count(self, numeric_type: Any, path: str) -> str:
        name = name_of(numeric_type)
        length_format(name)
        self._typed(path, name)
        return name


def _names(value_set: Any) -> Table:
    """Returns the named integers of a value set; `some_names` when others are legal too."""
    values = list(value_set.values) if value_set is not None else []
    named: dict[int, str] = {}
    for value in values:
        if value.eClass.name == "EnumeratedValue" and abs(int(value.value)) < _EXACT:
            named.setdefault(int(value.value), label(str(value.name)))
    if not named:
        return {}
    is_closed = all(value.eClass.name == "EnumeratedValue" for value in values)
    return {"names" if is_closed else "some_names": dict(sorted(named.items()))}
