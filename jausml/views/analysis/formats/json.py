"""Report as a structure of plain values, as JSON has it; the schema is beside this file."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from jausml.views.analysis.assumptions import runtime_constants

if TYPE_CHECKING:
    from jausml.views.analysis.budgets import Budget
    from jausml.views.analysis.report import (
        CallReport,
        ComponentReport,
        ConnectionReport,
        Flow,
        HostReport,
        Load,
        Report,
    )
    from jausml.views.analysis.sizes import Size
    from jausml.views.analysis.streams import Wire

FORMAT = 1
"""Version of the structure: keys are added under the same one."""

_DIGITS = 6


def render(report: Report) -> str:
    """Returns a report as JSON."""
    return json.dumps(to_plain(report), indent=2, ensure_ascii=True) + "\n"


def to_plain(report: Report) -> dict[str, Any]:
    """Returns a report as plain values."""
    assumptions = report.assumptions
    return {
        "format": FORMAT,
        "system": report.system,
        "assumptions": {
            "rate_hz": _number(assumptions.rate),
            "length": assumptions.length,
            "rates_hz": {name: _number(rate) for name, rate in sorted(assumptions.rates.items())},
            "lengths": dict(sorted(assumptions.lengths.items())),
        },
        "constants": {name: _number(each) for name, each in asdict(runtime_constants()).items()},
        "hosts": [_host(each) for each in report.hosts],
        "components": [_component(each) for each in report.components],
    }


def _host(host: HostReport) -> dict[str, Any]:
    return {
        "name": host.name,
        "transport": host.transport,
        "components": list(host.components),
        "load": _load(host.load),
    }


def _component(component: ComponentReport) -> dict[str, Any]:
    return {
        "name": component.name,
        "address": component.address,
        "is_bridge": component.is_bridge,
        "host": component.host,
        "load": _load(component.load),
        "upkeep": _load(component.upkeep),
        "processor_share": _number(component.share),
        "warnings": list(component.warnings),
        "connections": [_connection(each) for each in component.connections],
        "calls": [_call(each) for each in component.calls],
    }


def _call(call: CallReport) -> dict[str, Any]:
    return {
        "name": call.name,
        "direction": call.direction,
        "kind": call.kind,
        "ros_name": call.ros_name,
        "type": call.type,
        "messages": list(call.messages),
        "peers": list(call.peers),
        "timeout_s": _number(call.seconds),
    }


def _connection(connection: ConnectionReport) -> dict[str, Any]:
    return {
        "name": connection.name,
        "direction": connection.direction,
        "exchange": connection.exchange,
        "message": connection.message,
        "code": f"{connection.code:04X}",
        "type": connection.type,
        "topics": list(connection.topics),
        "joins": list(connection.joins),
        "peers": list(connection.peers),
        "fan_out": connection.fan_out,
        "flows": [_flow(each) for each in connection.flows],
        "load": _load(connection.load),
        "ros": {
            "bytes": _size(connection.ros_size),
            "messages_per_s": _number(connection.ros_rate),
        },
        "processor_share": _number(connection.share),
        "budgets": [_budget(each) for each in connection.budgets],
        "warnings": list(connection.warnings),
    }


def _flow(flow: Flow) -> dict[str, Any]:
    return {
        "sender": flow.sender,
        "receiver": flow.receiver,
        "message": flow.message,
        "kind": flow.kind,
        "bytes": _size(flow.size),
        "packets": flow.packets,
        "datagram_bytes": flow.datagram_bytes,
        "rate_hz": _number(flow.hertz),
        "rate_basis": flow.basis,
        "is_acknowledged": flow.is_acknowledged,
    }


def _budget(budget: Budget) -> dict[str, Any]:
    return {
        "case": budget.case,
        "seconds": None if budget.seconds is None else _number(budget.seconds),
        "never": budget.never,
        "steps": [{"name": each.name, "seconds": _number(each.seconds)} for each in budget.steps],
    }


def _load(load: Load) -> dict[str, Any]:
    return {
        "messages_sent_per_s": _number(load.messages_sent),
        "messages_received_per_s": _number(load.messages_received),
        "sent": _wire(load.sent),
        "received": _wire(load.received),
    }


def _wire(wire: Wire) -> dict[str, Any]:
    return {
        "packets_per_s": _number(wire.packets),
        "judp_bytes_per_s": _number(wire.judp),
        "ip_bytes_per_s": _number(wire.ip),
        "ethernet_bytes_per_s": _number(wire.ethernet),
    }


def _size(size: Size) -> dict[str, Any]:
    return {"least": size.least, "expected": size.expected, "most": size.most}


def _number(value: float) -> float | int:
    """Returns a number that reads the same on each computer."""
    rounded = float(f"{value:.{_DIGITS}g}") if not isinstance(value, int) else value
    return int(rounded) if rounded == int(rounded) else rounded
