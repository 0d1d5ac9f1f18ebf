"""Report as a structure of plain values, as JSON has it; the schema is beside this file."""

from __future__ import annotations

import json
from dataclasses import asdict, fields, is_dataclass
from typing import Any

from jausml.views.analysis.budgets import Budget
from jausml.views.analysis.report import (
    CallReport,
    ComponentReport,
    ConnectionReport,
    Flow,
    Load,
    Report,
)
from jausml.views.analysis.sizes import runtime_constants
from jausml.views.analysis.streams import Wire

FORMAT = 1
"""Version of the structure: keys are added under the same one."""

_DIGITS = 6

_KEYS = {
    Wire: {
        "packets": "packets_per_s",
        "judp": "judp_bytes_per_s",
        "ip": "ip_bytes_per_s",
        "ethernet": "ethernet_bytes_per_s",
    },
    Load: {"messages_sent": "messages_sent_per_s", "messages_received": "messages_received_per_s"},
    Flow: {"size": "bytes", "hertz": "rate_hz", "basis": "rate_basis"},
    ConnectionReport: {"share": "processor_share"},
    ComponentReport: {"share": "processor_share"},
    CallReport: {"seconds": "timeout_s"},
}
"""Keys that are other than the names of what they hold: most say the unit."""


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
        "constants": {
            name: _number(constant) for name, constant in asdict(runtime_constants()).items()
        },
        "hosts": _plain(report.hosts),
        "components": _plain(report.components),
        "changes": list(report.changes),
    }


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if isinstance(value, Budget):
        seconds, steps = _plain(value.seconds), _plain(value.steps)
        return {"case": value.case, "seconds": seconds, "never": value.never, "steps": steps}
    if not is_dataclass(value):
        return value
    keys = _KEYS.get(type(value), {})
    return {
        keys.get(field.name, field.name): _plain(getattr(value, field.name))
        for field in fields(value)
    }


def _number(value: float) -> float | int:
    """Returns a number that reads the same on each computer."""
    rounded = float(f"{value:.{_DIGITS}g}") if not isinstance(value, int) else value
    return int(rounded) if rounded == int(rounded) else rounded
