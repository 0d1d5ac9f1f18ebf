"""Fields and containers of message bodies: JSIDL elements become elements of the model.

Declared types are unfolded where they are used, as in the shipped library: a message says all
about its layout by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.jsidl.building import DEEPEST, Builder
from jausml.language.importers.jsidl.scopes import Declaration, MissingError, Scope, Scopes
from jausml.language.importers.jsidl.vocabulary import (
    CONTAINERS,
    FIELDS,
    INT,
    LONG,
    Values,
    children,
    documentation,
    folded,
    joined,
    largest,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import show

_ROUNDINGS = {name: name for name in ("round", "floor", "ceiling")}
_BOUNDS = {"inclusive": "inclusive", "exclusive": "exclusive"}
_DECLARED = "declared_"
_VALUE_SETS = ("value_set", f"{_DECLARED}value_set")

Made: TypeAlias = "tuple[type[jaus.Field], dict[str, Any]]"
"""Class and features of a field."""


class FieldBuilder:
    """Makes fields."""

    def __init__(self, builder: Builder, scopes: Scopes, findings: ImportFindings) -> None:
        self._builder = builder
        self._scopes = scopes
        self._findings = findings
        self._values = Values(scopes, findings)
        self._open: list[NodePlace] = []
        self._kinds: dict[str, Callable[[Scope, NodePlace], Made]] = {
            "record": self._record,
            "sequence": self._sequence,
            "list": self._list,
            "variant": self._variant,
            "array": self._array,
            "fixed_field": self._fixed_field,
            "variable_field": self._variable_field,
            "bit_field": self._bit_field,
            "fixed_length_string": self._fixed_length_string,
            "variable_length_string": self._variable_length_string,
            "variable_length_field": self._variable_length_field,
            "variable_format_field": self._variable_format_field,
        }

    def field(self, scope: Scope, place: NodePlace) -> jaus.Field | None:
        """Makes a field or container.

        Args:
            place: Its element, which may refer to a declared type.

        Returns:
            The field; None when what is wrong with it was reported.
        """
        target = self.resolve(Declaration(scope, place))
        if target is None:
            return None
        name = self._values.text(place, "name")
        if target.place in self._open:
            message = f"{show(name)} contains itself"
            self._findings.report("JML610", place, message, "a message has an end on the wire")
            return None
        if len(self._open) >= DEEPEST:
            self._findings.report("JML612", place, f"{show(name)} is nested too deeply")
            return None
        self._open.append(target.place)
        try:
            kind, features = self._kinds[target.place.node.tag](target.scope, target.place)
        finally:
            self._open.pop()
        said = documentation(place.node) or documentation(target.place.node)
        further = features.pop("documentation", None)
        return self._builder.new(
            kind,
            place,
            name=name,
            documentation=joined(said, further),
            optional=self._values.flag(place, "optional") or None,
            **features,
        )

    def check(self, scope: Scope, place: NodePlace) -> None:
        """Checks a declaration that is not used."""
        target = self.resolve(Declaration(scope, place))
        tag = target.place.node.tag if target is not None else ""
        if target is not None and tag == "value_set":
            self._value_set(target.scope, target.place)
        elif tag in self._kinds:
            self.field(scope, place)

    def resolve(self, declaration: Declaration, missing: str = "JML608") -> Declaration | None:
        """Follows declared_... references to what they stand for.

        Args:
            missing: The rule of a reference that leads to nothing.

        Returns:
            What it stands for; None after a report.
        """
        passed: list[NodePlace] = []
        while declaration.place.node.tag.startswith(_DECLARED):
            place = declaration.place
            path = "".join(folded(place.node.get("declared_type_ref")).split())
            if not path:
                return None  # reported as missing
            at = place.at("declared_type_ref")
            if place in passed:
                self._findings.report("JML610", at, f"{show(path)} leads back to itself")
                return None
            passed.append(place)
            try:
                target = self._scopes.find(declaration.scope, path)
            except MissingError as error:
                if not error.is_known:
                    self._findings.report(missing, at, str(error), error.hint)
                return None
            wanted = place.node.tag.removeprefix(_DECLARED)
            actual = target.place.node.tag.removeprefix(_DECLARED)
            if actual != wanted:
                message = f"{show(path)} is a {actual}, but <{place.node.tag}> takes a {wanted}"
                self._findings.report("JML609", at, message)
                return None
            declaration = target
        return declaration

    # -- containers ------------------------------------------------------------------------------

    def _record(self, scope: Scope, place: NodePlace) -> Made:
        return jaus.Record, self._members(scope, place, (*FIELDS, "array"))

    def _sequence(self, scope: Scope, place: NodePlace) -> Made:
        return jaus.Sequence, self._members(scope, place, CONTAINERS)

    def _members(self, scope: Scope, place: NodePlace, kinds: Sequence[str]) -> dict[str, Any]:
        vector = self._child(place, "presence_vector")
        members = self._parts(place, kinds)
        if not members:
            what = f"<{place.node.tag}> {show(place.node.get('name') or '')}"
            self._findings.report("JML604", place, f"{what} has no member")
        return {
            "presenceVector": self._values.unsigned_type(vector) if vector else None,
            "fields": self._fields(scope, members),
        }

    def _list(self, scope: Scope, place: NodePlace) -> Made:
        element = self._only(place, self._parts(place, CONTAINERS), "container")
        features = self._count(scope, place, "Count")
        features["element"] = self.field(scope, element) if element else None
        return jaus.List, features

    def _variant(self, scope: Scope, place: NodePlace) -> Made:
        options = self._parts(place, CONTAINERS)
        tag = self._needed(place, "vtag_field")
        tag_type = self._values.unsigned_type(tag) if tag else None
        if tag is not None:
            lowest = self._values.integer(scope, tag, "min_count", LONG)
            highest = self._values.integer(scope, tag, "max_count", LONG)
            if lowest not in (None, 0):
                message = f"the tag of {_name(place)} counts from {lowest}, not from 0"
                self._findings.report("JML613", tag.at("min_count"), message)
            elif options and highest not in (None, len(options) - 1):
                message = f"the tag of {_name(place)} ends at {highest}"
                hint = f"{len(options)} options are 0..{len(options) - 1}; the tag was not bounded"
                self._findings.report("JML626", tag.at("max_count"), message, hint)
        options_made = self._fields(scope, options)
        said = documentation(tag.node) if tag else None
        return jaus.Variant, {"tagType": tag_type, "options": options_made, "documentation": said}

    def _array(self, scope: Scope, place: NodePlace) -> Made:
        element = self._only(place, self._parts(place, (*FIELDS, "array")), "field")
        dimensions = children(place, "dimension")
        if not dimensions:
            self._findings.report("JML604", place, f"array {_name(place)} has no <dimension>")
        sizes = [
            self._values.integer(scope, dimension, "size", (1, INT[1])) for dimension in dimensions
        ]
        element_field = self.field(scope, element) if element else None
        return jaus.Array, {
            "element": element_field,
            "dimensions": [size for size in sizes if size is not None],
            "documentation": documentation(*(dimension.node for dimension in dimensions)),
        }

    def _fields(self, scope: Scope, places: Sequence[NodePlace]) -> list[jaus.Field]:
        fields = [self.field(scope, place) for place in places]
        return [field for field in fields if field is not None]

    # -- fields ----------------------------------------------------------------------------------

    def _fixed_field(self, scope: Scope, place: NodePlace) -> Made:
        return jaus.FixedField, self._number(scope, place)

    def _number(self, scope: Scope, place: NodePlace) -> dict[str, Any]:
        units = self._values.text(place, "field_units")
        scale = self._child(place, "scale_range")
        values = self._child(place, *_VALUE_SETS)
        said = documentation(*(node.node for node in (scale, values) if node is not None))
        return {
            "type": self._values.numeric_type(place, "field_type"),
            "units": units if units != "one" else None,
            "scale": self._scale(scope, scale) if scale else None,
            "values": self._values_of(scope, values),
            "documentation": said,
        }

    def _scale(self, scope: Scope, place: NodePlace) -> jaus.ScaleRange:
        return self._builder.new(
            jaus.ScaleRange,
            place,
            lower=self._values.real(scope, place, "real_lower_limit"),
            upper=self._values.real(scope, place, "real_upper_limit"),
            rounding=self._values.choice(place, "integer_function", _ROUNDINGS),
        )

    def _values_of(self, scope: Scope, place: NodePlace | None) -> jaus.ValueSet | None:
        """Makes the values of a number of their element, which may refer to a declared set."""
        target = self.resolve(Declaration(scope, place)) if place else None
        return self._value_set(target.scope, target.place) if target else None

    def _value_set(self, scope: Scope, place: NodePlace) -> jaus.ValueSet | None:
        is_offset = self._values.flag(place, "offset_to_lower_limit")
        values = [self._value(scope, child) for child in children(place)]
        if not values:
            self._findings.report("JML604", place, "<value_set> has no value")
            return None
        return self._builder.new(
            jaus.ValueSet, place, values=values, offsetToLowerLimit=is_offset or None
        )

    def _value(self, scope: Scope, place: NodePlace) -> jaus.Value:
        said = documentation(place.node)
        if place.node.tag == "value_enum":
            return self._builder.new(
                jaus.EnumeratedValue,
                place,
                documentation=said,
                name=self._values.text(place, "enum_const"),
                value=self._values.integer(scope, place, "enum_index", LONG),
            )
        lower = self._values.choice(place, "lower_limit_type", _BOUNDS)
        upper = self._values.choice(place, "upper_limit_type", _BOUNDS)
        return self._builder.new(
            jaus.ValueRange,
            place,
            documentation=said,
            lower=self._values.real(scope, place, "lower_limit"),
            upper=self._values.real(scope, place, "upper_limit"),
            lowerInclusive=lower != "exclusive",
            upperInclusive=upper != "exclusive",
        )

    def _variable_field(self, scope: Scope, place: NodePlace) -> Made:
        choices = self._needed(place, "type_and_units_field")
        alternatives = []
        for child in children(choices, "type_and_units_enum") if choices else []:
            features = self._number(scope, child)
            said = joined(documentation(child.node), features["documentation"])
            features.update(
                name=self._values.text(child, "name"),
                index=self._values.integer(scope, child, "index"),
                documentation=said,
            )
            alternatives.append(self._builder.new(jaus.Alternative, child, **features))
        if choices and not alternatives:
            self._findings.report("JML604", choices, f"{_name(place)} has no alternative")
        said = documentation(choices.node) if choices else None
        return jaus.VariableField, {"alternatives": alternatives, "documentation": said}

    def _bit_field(self, scope: Scope, place: NodePlace) -> Made:
        parts = [self._sub_field(scope, child) for child in children(place, "sub_field")]
        if not parts:
            self._findings.report("JML604", place, f"bit_field {_name(place)} has no <sub_field>")
        field_type = self._values.unsigned_type(place)
        return jaus.BitField, {"type": field_type, "subFields": parts}

    def _sub_field(self, scope: Scope, place: NodePlace) -> jaus.SubField:
        bits = self._needed(place, "bit_range")
        values = self._child(place, *_VALUE_SETS)
        first, last = (
            self._values.integer(scope, bits, name) if bits else None
            for name in ("from_index", "to_index")
        )
        return self._builder.new(
            jaus.SubField,
            place,
            name=self._values.text(place, "name"),
            documentation=documentation(
                *(part.node for part in (place, bits, values) if part is not None)
            ),
            lowBit=first,
            highBit=last,
            values=self._values_of(scope, values),
        )

    def _fixed_length_string(self, scope: Scope, place: NodePlace) -> Made:
        length = self._values.integer(scope, place, "string_length", (1, INT[1]))
        return jaus.FixedLengthString, {"length": length}

    def _variable_length_string(self, scope: Scope, place: NodePlace) -> Made:
        return jaus.VariableLengthString, self._count(scope, place, "Length")

    def _variable_length_field(self, scope: Scope, place: NodePlace) -> Made:
        data_format = self._values.text(place, "field_format") or None
        return jaus.VariableLengthField, {
            "format": data_format,
            **self._count(scope, place, "Length"),
        }

    def _variable_format_field(self, scope: Scope, place: NodePlace) -> Made:
        choices = self._needed(place, "format_field")
        formats = [
            self._builder.new(
                jaus.Format,
                child,
                name=self._values.text(child, "field_format"),
                documentation=documentation(child.node),
                index=self._values.integer(scope, child, "index"),
            )
            for child in (children(choices, "format_enum") if choices else [])
        ]
        if choices and not formats:
            self._findings.report("JML604", choices, f"{_name(place)} has no format")
        features = self._count(scope, place, "Length")
        said = joined(documentation(choices.node if choices else None), features["documentation"])
        return jaus.VariableFormatField, {**features, "formats": formats, "documentation": said}

    def _count(self, scope: Scope, place: NodePlace, what: str) -> dict[str, Any]:
        """Returns the features of a count: its type and its bounds."""
        count = self._needed(place, "count_field")
        if count is None:
            return {"documentation": None}
        count_type = self._values.unsigned_type(count)
        minimum = self._values.integer(scope, count, "min_count", (0, LONG[1]))
        # 2^64 - 1 means no bound: the model's numbers end at 2^63 - 1.
        maximum = self._values.integer(scope, count, "max_count", (0, 2**64 - 1))
        if maximum == 0:
            message = f"{_name(place)} is always empty"
            hint = "0 means no bound in the model; leave the field out, or allow 1"
            self._findings.report("JML613", count.at("max_count"), message, hint)
        elif maximum is not None and (
            (count_type and maximum == largest(count_type)) or maximum > LONG[1]
        ):
            maximum = None
        return {
            "countType": count_type,
            f"minimum{what}": minimum or None,
            f"maximum{what}": maximum,
            "documentation": documentation(count.node),
        }

    # -- children --------------------------------------------------------------------------------

    def _parts(self, place: NodePlace, kinds: Sequence[str]) -> list[NodePlace]:
        return children(place, *kinds, *(f"{_DECLARED}{kind}" for kind in kinds))

    def _child(self, place: NodePlace, *tags: str) -> NodePlace | None:
        places = children(place, *tags)
        for second in places[1:]:
            self._findings.report("JML602", second, f"second <{tags[0]}> of {_name(place)}")
        return places[0] if places else None

    def _needed(self, place: NodePlace, tag: str) -> NodePlace | None:
        child = self._child(place, tag)
        if child is None:
            self._findings.report(
                "JML604", place, f"<{place.node.tag}> {_name(place)} has no <{tag}>"
            )
        return child

    def _only(self, place: NodePlace, places: Sequence[NodePlace], what: str) -> NodePlace | None:
        if len(places) == 1:
            return places[0]
        message = f"<{place.node.tag}> {_name(place)} has {len(places)} {what}s, not one"
        if places:
            self._findings.report("JML602", places[1], message)
        else:
            self._findings.report("JML604", place, message)
        return None


def _name(place: NodePlace) -> str:
    return show(folded(place.node.get("name")))
