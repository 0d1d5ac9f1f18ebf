"""Messages and internal events: JSIDL elements become elements of the model."""

from __future__ import annotations

import re

from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.jsidl.building import Builder
from jausml.language.importers.jsidl.fields import FieldBuilder
from jausml.language.importers.jsidl.scopes import Declaration, Scope, Scopes
from jausml.language.importers.jsidl.vocabulary import (
    CONTAINERS,
    Values,
    children,
    documentation,
    folded,
    joined,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import show

_HEADER_NOT_FOUND = "JML628"
_CODE = re.compile("(?:0[xX])?([0-9A-Fa-f]{1,4})")
_CONTAINERS = frozenset([*CONTAINERS, *(f"declared_{name}" for name in CONTAINERS)])


class MessageBuilder:
    """Makes messages and internal events."""

    def __init__(
        self, builder: Builder, fields: FieldBuilder, scopes: Scopes, findings: ImportFindings
    ) -> None:
        self._builder = builder
        self._fields = fields
        self._findings = findings
        self._values = Values(scopes, findings)

    def message(self, scope: Scope, place: NodePlace) -> jaus.MessageDef | None:
        """Makes a message.

        Returns:
            The message; None when what is wrong with it was reported.
        """
        target = self._fields.resolve(Declaration(scope, place))
        if target is None:
            return None
        code = self._code(target.place)
        self._check_header(target)
        self._check_footer(target)
        body, said = self._body(target)
        return self._builder.new(
            jaus.MessageDef,
            place,
            name=self._values.text(place, "name"),
            documentation=self._said(place, target.place, said),
            code=code,
            isCommand=self._values.flag(target.place, "is_command") or None,
            body=body,
        )

    def event(self, scope: Scope, place: NodePlace) -> jaus.InternalEvent | None:
        """Makes an internal event; arguments and result as for `message`."""
        target = self._fields.resolve(Declaration(scope, place))
        if target is None:
            return None
        self._check_empty(target, "header")
        self._check_footer(target)
        body, said = self._body(target)
        return self._builder.new(
            jaus.InternalEvent,
            place,
            name=self._values.text(place, "name"),
            documentation=self._said(place, target.place, said),
            body=body,
        )

    def _said(self, place: NodePlace, target: NodePlace, further: str | None) -> str | None:
        own = documentation(place.node) if place != target else None
        descriptions = children(target, "description")
        said = own or documentation(
            target.node, *(description.node for description in descriptions)
        )
        return joined(said, further)

    def _code(self, place: NodePlace) -> str | None:
        text = "".join(folded(place.node.get("message_id")).split())
        match = _CODE.fullmatch(text)
        if match is not None:
            return f"0x{int(match.group(1), 16):04X}"
        if text:
            message = f"'message_id' {show(text)} is no message code"
            hint = "write up to four hexadecimal digits, as 4404"
            self._findings.report("JML605", place.at("message_id"), message, hint)
        return None

    def _part(self, target: Declaration, tag: str, missing: str = "JML608") -> Declaration | None:
        """Returns header, body or footer of a message with what a reference stands for."""
        parts = children(target.place, tag, f"declared_{tag}")
        for second in parts[1:]:
            self._findings.report("JML602", second, f"second <{tag}> of {_name(target.place)}")
        if not parts:
            return None
        return self._fields.resolve(Declaration(target.scope, parts[0]), missing)

    def _container(self, part: Declaration) -> NodePlace | None:
        containers = children(part.place, *_CONTAINERS)
        for second in containers[1:]:
            message = f"<{part.place.node.tag}> has a second container, <{second.node.tag}>"
            self._findings.report("JML602", second, message, "put both into a sequence")
        return containers[0] if containers else None

    def _body(self, target: Declaration) -> tuple[jaus.Field | None, str | None]:
        body = self._part(target, "body")
        if body is None:
            return None, None
        said = documentation(body.place.node)
        container = self._container(body)
        return (self._fields.field(body.scope, container) if container else None), said

    def _check_header(self, target: Declaration) -> None:
        """Checks that the header is the message code alone, as codecs write it.

        Published sets refer to headers that they do not declare: each would be the same.
        """
        header = self._part(target, "header", _HEADER_NOT_FOUND)
        container = self._container(header) if header else None
        if header is None or container is None:
            return
        record = self._fields.resolve(Declaration(header.scope, container), _HEADER_NOT_FOUND)
        if record is None:
            return
        inside = children(record.place)
        fields = children(record.place, "fixed_field", "declared_fixed_field")
        is_code = record.place.node.tag == "record" and len(inside) == len(fields) == 1
        if is_code:
            field = self._fields.resolve(Declaration(record.scope, fields[0]), _HEADER_NOT_FOUND)
            if field is None:
                return
            is_code = folded(field.place.node.get("field_type")) == "unsigned short integer"
        if not is_code:
            message = f"the header of {_name(target.place)} is not the message code alone"
            hint = "a header is one fixed_field of type unsigned short integer"
            self._findings.report("JML613", record.place, message, hint)

    def _check_footer(self, target: Declaration) -> None:
        self._check_empty(target, "footer")

    def _check_empty(self, target: Declaration, tag: str) -> None:
        part = self._part(target, tag)
        container = self._container(part) if part else None
        if container is not None:
            message = f"the {tag} of {_name(target.place)} has fields"
            self._findings.report("JML613", container, message, "put them into the body")


def _name(place: NodePlace) -> str:
    return show(folded(place.node.get("name")))
