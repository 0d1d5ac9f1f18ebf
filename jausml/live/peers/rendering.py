"""Views of an operator: subsystems, services, states and reports, as text or as JSON."""

from __future__ import annotations

import json
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from jausml.live.peers.discovery import type_name
from jausml.live.peers.services import controller_of
from jausml.live.peers.values import shown_fields

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.live.messages import MessageEntry
    from jausml.live.peers.discovery import KnownComponent, KnownSubsystem
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.messages import ReportControl
    from jausml.runtime.services.definitions import ServiceIdentity, Status


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
    """Returns one JSON object with all subsystems."""
    content = [
        {
            "subsystem": each.number,
            "identification": printable(each.identification),
            "type": each.type,
            "components": [_component(component) for component in each.components.values()],
        }
        for each in subsystems
    ]
    return json.dumps({"subsystems": content}, indent=2)


def service_lines(services: Sequence[ServiceIdentity]) -> Iterator[str]:
    """Yields one line for each service."""
    for service in services:
        yield f"{printable(service.urn)} {service.major}.{service.minor}"


def services_json(target: JausAddress, services: Sequence[ServiceIdentity]) -> str:
    """Returns one JSON object with the services of a component."""
    return json.dumps({"component": str(target), "services": _services(services)}, indent=2)


def status_line(state: Status | None, control: ReportControl | None) -> str:
    """Returns the state of a component and who controls it."""
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
    """Returns when control lapses, in words; empty if that is not known.

    Args:
        timeout: Seconds after the last request, 0 for never.
    """
    if timeout is None:
        return ""
    return f"control lapses {timeout} s after the last request" if timeout else "it never lapses"


def status_json(
    target: JausAddress,
    state: Status | None,
    control: ReportControl | None,
    timeout: int | None = None,
) -> str:
    """Returns one JSON object with the state of a component, who controls it, and until when."""
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
    """Returns text of a peer with everything that could move a terminal's cursor escaped."""
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
        {"urn": printable(each.urn), "version": f"{each.major}.{each.minor}"} for each in services
    ]
