"""Text and JSON of subsystems, services, states, reports and their fields, for operators."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime, timezone
from typing import Any

from jausml.language import wire
from jausml.live.messages import EmbeddedMessage, MessageEntry
from jausml.live.messages.codec import TAG
from jausml.live.messages.counted import MESSAGE
from jausml.live.messages.text import named
from jausml.live.messages.values import with_unit
from jausml.live.messages.walking import parts
from jausml.live.peers.discovery import KnownComponent, KnownSubsystem, controller_of, type_name
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ReportControl
from jausml.runtime.services.definitions import ServiceIdentity, Status

# Fields of a TimeStamp (AS5710, ReportTime; AS6009).
_CLOCK = {"Hour", "Minutes", "Seconds", "Milliseconds"}


def shown_fields(entry: MessageEntry, fields: dict[str, Any]) -> str:
    """Returns the fields of a message on one line, e.g. `Velocity_X=1.25 m/s YawRate=0 rad/s`."""
    pairs = list(field_texts(entry.record, fields))
    return "  ".join(f"{path}={text}" for path, text in pairs) or "(no fields)"


Leaf = tuple[str, wire.Kind, Any]  # the path of a value, its kind, and the value


def leaves(kind: wire.Kind, value: Any, path: str = "") -> Iterator[Leaf]:
    """Yields the values without parts, and empty lists; paths leave out the outermost record."""
    inside = list(parts(kind, value))
    if not inside and not isinstance(kind, wire.Record):
        yield path, kind, value
    outermost = isinstance(kind, wire.Record) and len(kind.members) == 1 and not path
    for name, inner, part in inside:
        step = "" if outermost and isinstance(inner, wire.Record) else name
        yield from leaves(inner, part, _joined(path, step))


def field_texts(kind: wire.Kind, value: Any) -> Iterator[tuple[str, str]]:
    """Yields the path and the text of each value."""
    for path, leaf, inner in leaves(kind, value):
        match leaf:
            case wire.List() | wire.Array():
                yield path, "[]"
            case wire.Variant():
                yield _joined(path, TAG), str(inner[TAG])
            case wire.BitField():
                yield from _bit_texts(leaf, inner, path)
            case wire.Octets() | wire.FormattedOctets() if MESSAGE in inner:
                yield from _message_texts(inner[MESSAGE], path)
            case _:
                yield path, _leaf(leaf, inner)


def _message_texts(embedded: EmbeddedMessage, path: str) -> Iterator[tuple[str, str]]:
    decoded = embedded.decoded
    if decoded is None:
        yield path, f"({embedded['error']})"
        return
    inner = list(field_texts(decoded.entry.record, decoded.fields))
    for step, text in inner or [("", "(no fields)")]:
        yield _joined(_joined(path, decoded.entry.name), step), text


def _bit_texts(kind: wire.BitField, value: dict[str, Any], path: str) -> Iterator[tuple[str, str]]:
    if value.keys() >= _CLOCK:
        yield path, _clock(value)
        return
    for group in kind.groups:
        yield _joined(path, group.name), named(group.legal, value[group.name])


def _clock(value: dict[str, int]) -> str:
    day = f"day {value['Day']} " if "Day" in value else ""
    seconds = f"{value['Seconds']:02}.{value['Milliseconds']:03}"
    return f"{day}{value['Hour']:02}:{value['Minutes']:02}:{seconds}"


def _leaf(kind: wire.Kind, value: Any) -> str:
    match kind:
        case wire.VariableNumber():
            return _leaf(kind.by_index[value["index"]], value["value"])
        case wire.Integer():
            return with_unit(named(kind.legal, value), kind.units)
        case wire.Scaled():
            # As many digits as the step of the scale needs.
            return with_unit(_rounded(value, kind.step), kind.units)
        case wire.Real():
            return with_unit(f"{value:.7g}", kind.units)
        case wire.Octets() | wire.FormattedOctets():
            return str(value["hex"])
        case _:
            return repr(value)


def _joined(path: str, step: str) -> str:
    dot = "." if path and step and not step.startswith("[") else ""
    return f"{path}{dot}{step}"


def _rounded(value: float, step: float) -> str:
    digits = 0
    while digits < 9 and step * 10**digits < 1:
        digits += 1
    return f"{value:.{digits}f}" if abs(round(value, digits)) > 0 else "0"


def subsystem_lines(subsystems: Iterable[KnownSubsystem]) -> Iterator[str]:
    """Yields the subsystems with their nodes, components and services."""
    for subsystem in subsystems:
        yield f"subsystem {subsystem.number}{_who(subsystem.identification, subsystem.type)}"
        node = 0
        for address, component in subsystem.components.items():
            if address.node != node:
                node = address.node
                yield f"  node {node}"
            silent = " answers, but offers no Discovery" if component.is_silent else ""
            yield f"    {address}{_who(component.identification, component.type)}{silent}"
            yield from (f"      {line}" for line in service_lines(component.services))


def subsystems_json(subsystems: Iterable[KnownSubsystem]) -> str:
    """Returns subsystems as the text of one JSON object."""
    content = [
        {
            "subsystem": subsystem.number,
            "identification": printable(subsystem.identification),
            "type": subsystem.type,
            "components": [_component(component) for component in subsystem.components.values()],
        }
        for subsystem in subsystems
    ]
    return json.dumps({"subsystems": content}, indent=2)


def service_lines(services: Sequence[ServiceIdentity]) -> Iterator[str]:
    """Yields one line for each service."""
    for service in services:
        yield f"{printable(service.urn)} {service.major}.{service.minor}"


def services_json(target: JausAddress, services: Sequence[ServiceIdentity]) -> str:
    """Returns the services of a component as the text of one JSON object."""
    return json.dumps({"component": str(target), "services": _services(services)}, indent=2)


def status_line(state: Status | None, control: ReportControl | None) -> str:
    """Returns the state and the controller of a component in words."""
    words = [state.name if state is not None else "state unknown"]
    if control is None:
        words.append("controller unknown")
    elif control.subsystem_id:
        words.append(
            f"controlled by {controller_of(control)} with authority {control.authority_code}"
        )
    else:
        words.append(f"not controlled, default authority {control.authority_code}")
    return "; ".join(words)


def lapse_words(timeout: int | None) -> str:
    """Returns when control lapses, in words; empty for None (`timeout`: seconds, 0 for never)."""
    if timeout is None:
        return ""
    return f"control lapses {timeout} s after the last request" if timeout else "it never lapses"


def status_json(
    target: JausAddress,
    state: Status | None,
    control: ReportControl | None,
    timeout: int | None = None,
) -> str:
    """Returns state, controller and control timeout (s) as the text of one JSON object."""
    controller = controller_of(control) if control is not None and control.subsystem_id else None
    content = {
        "component": str(target),
        "status": None if state is None else state.name,
        "controller": controller,
        "authority": None if control is None else control.authority_code,
        "control_timeout": timeout,
    }
    return json.dumps(content)


def report_line(source: JausAddress, entry: MessageEntry, fields: dict[str, Any]) -> str:
    """Returns a report on one line, with the present time of day and the units of its values."""
    now = datetime.now().astimezone().strftime("%H:%M:%S.%f")[:-3]
    return f"{now} {source} {entry.name}  {printable(shown_fields(entry, fields))}"


def report_json(source: JausAddress, entry: MessageEntry, fields: dict[str, Any]) -> str:
    """Returns a report as one JSON object on one line, with the present time in UTC."""
    content = {
        "time": datetime.now(timezone.utc).isoformat(timespec="milliseconds"),
        "source": str(source),
        "message": entry.name,
        "code": entry.code_text,
        "fields": fields,
    }
    return json.dumps(content)


def printable(text: str) -> str:
    """Returns text of a peer with all characters escaped that a terminal does not print."""
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)


def _who(identification: str, number: int) -> str:
    words = [f"'{printable(identification)}'"] if identification else []
    if type_name(number):
        words.append(f"({type_name(number)})")
    return "".join(f" {word}" for word in words)


def _component(component: KnownComponent) -> dict[str, Any]:
    return {
        "id": str(component.address),
        "identification": printable(component.identification),
        "type": component.type,
        "discovery": not component.is_silent,
        "services": _services(component.services),
    }


def _services(services: Sequence[ServiceIdentity]) -> list[dict[str, str]]:
    return [
        {"urn": printable(service.urn), "version": f"{service.major}.{service.minor}"}
        for service in services
    ]
