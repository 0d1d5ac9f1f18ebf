"""Messages of a component, and forms for their fields: kinds, units, ranges and choices."""

from __future__ import annotations

from typing import Any

from jausml.language import wire
from jausml.live.messages import MessageEntry, MessageError
from jausml.live.messages.values import symbol
from jausml.live.operating.sticks import Sticks
from jausml.live.operating.watching import WatchedSystem
from jausml.live.peers.discovery import label_of
from jausml.live.peers.query_client import Refused
from jausml.live.peers.rendering import shown_fields
from jausml.runtime.base.address import JausAddress


def offers_of(system: WatchedSystem, sticks: Sticks, target: JausAddress) -> dict[str, Any]:
    """Returns the services, commands and reports of a component, as JSON values."""
    operator = system.operator
    provided = operator.services(target)
    labels = set(map(label_of, provided))
    commands: dict[str, tuple[str, MessageEntry]] = {}
    reports = set()
    for service in operator.catalogue.services.values():
        for owner in service.lineage if service.label in labels else ():
            for entry in owner.inputs:
                if entry.name.startswith("Query"):
                    reports.add(entry.name.removeprefix("Query"))
                elif entry.is_command and system.takes(target, entry.name):
                    commands.setdefault(entry.name, (owner.name, entry))
    return {
        "services": sorted({identity.urn.rpartition(":")[2] for identity in provided}),
        "commands": [
            {
                "name": name,
                "service": service_name,
                "documentation": entry.documentation,
                "stick": _stick(sticks, target, entry),
            }
            for name, (service_name, entry) in sorted(commands.items())
        ],
        "reports": [{"name": name} for name in sorted(reports)],
    }


def _stick(sticks: Sticks, target: JausAddress, entry: MessageEntry) -> dict[str, Any]:
    """Returns the stop of a command that is repeated (see `sticks`), or why it has none."""
    try:
        stop = sticks.stop_of(target, entry)
    except (Refused, MessageError) as error:
        return {"refusal": str(error)}
    shown = shown_fields(entry, entry.decode(entry.encode(stop.fields)))
    return {"stop": shown, "timeout": stop.timeout, "source": stop.source}


def form_of(entry: MessageEntry) -> list[dict[str, Any]]:
    """Returns the fields of a message as JSON values, each with its inner fields."""
    return [_field(member) for member in entry.record.members]


def _field(field: wire.Field) -> dict[str, Any]:
    return {
        "name": field.name,
        "documentation": field.documentation,
        "optional": field.is_optional,
        **_kind(field.kind),
    }


def _kind(kind: wire.Kind) -> dict[str, Any]:
    match kind:
        case wire.Integer() | wire.Real() | wire.Scaled():
            return {"kind": "number", **_number(kind)}
        case wire.BitField():
            members = [
                {"name": group.name, "documentation": group.documentation, "optional": False,
                 "kind": "number", **_integer(group.legal, "")}
                for group in kind.groups
            ]  # fmt: skip
            return {"kind": "group", "members": members}
        case wire.Record():
            return {"kind": "group", "members": [_field(member) for member in kind.members]}
        case wire.List():
            return {"kind": "list", **_span(kind.count), "element": _field(kind.element)}
        case wire.Array():
            ends = {"least": kind.length, "most": kind.length}
            return {"kind": "list", **ends, "element": _field(kind.element)}
        case wire.Variant():
            return {"kind": "variant", "options": [_field(option) for option in kind.options]}
        case _:
            return _leaf(kind)


def _leaf(
    kind: wire.FixedText | wire.Text | wire.Octets | wire.FormattedOctets | wire.VariableNumber,
) -> dict[str, Any]:
    match kind:
        case wire.VariableNumber():
            alternatives = [
                {
                    "index": alternative.index,
                    "name": alternative.name,
                    **_number(alternative.number),
                }
                for alternative in kind.alternatives
            ]
            return {"kind": "variable", "alternatives": alternatives}
        case wire.FixedText():
            return {"kind": "text", "least": 0, "most": kind.length}
        case wire.Text():
            return {"kind": "text", **_span(kind.count)}
        case wire.Octets():
            return {"kind": "octets", **_span(kind.count)}
        case _:
            formats = [
                {"index": wire_format.index, "name": wire_format.name}
                for wire_format in kind.formats
            ]
            return {"kind": "formatted", **_span(kind.count), "formats": formats}


def _span(count: wire.Count) -> dict[str, Any]:
    return {"least": count.lower, "most": count.upper}


def _number(kind: wire.Number) -> dict[str, Any]:
    match kind:
        case wire.Integer():
            return _integer(kind.legal, kind.units)
        case wire.Scaled():
            ends = [[kind.lower, kind.upper]]
            return {"integer": False, "ranges": ends, "choices": [], "units": symbol(kind.units)}
        case _:
            ends = [[kind.legal.lower, kind.legal.upper]]
            return {"integer": False, "ranges": ends, "choices": [], "units": symbol(kind.units)}


def _integer(legal: wire.LegalIntegers, units: str) -> dict[str, Any]:
    return {
        "integer": True,
        "ranges": [list(interval) for interval in legal.ranges],
        "choices": [
            {"value": named_value.value, "label": named_value.name} for named_value in legal.listed
        ],
        "units": symbol(units),
    }
