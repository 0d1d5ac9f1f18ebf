"""Words and numbers as people read them, for the forms of a report."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.views.analysis.assumptions import Assumptions
    from jausml.views.analysis.budgets import Budget
    from jausml.views.analysis.report import CallReport, ConnectionReport
    from jausml.views.analysis.sizes import Size

CASES = {
    "normal": "normal",
    "queue_full": "queue full",
    "one_lost_packet": "one lost packet",
    "source_dead": "source dead",
    "controller_dead": "controller dead",
}
"""The cases of budgets, as they are called."""

WAYS = {"jausToRos": "to ROS", "rosToJaus": "to JAUS"}


def size(bounds: Size) -> str:
    """Returns the bounds of a size, such as `12..26`; `+` where nothing limits it."""
    if bounds.most is None:
        return f"{bounds.least}+"
    return str(bounds.least) if bounds.least == bounds.most else f"{bounds.least}..{bounds.most}"


def sizes(connection: ConnectionReport) -> str:
    """Returns the bounds of the greatest message that a connection carries."""
    if not connection.flows:
        return "-"
    return size(max((each.size for each in connection.flows), key=lambda each: each.expected))


def rate(connection: ConnectionReport) -> str:
    """Returns the rate of a connection; `~` before one that is assumed."""
    flows = [each for each in connection.flows if each.kind != "query"]
    if not flows:
        return "-"
    fastest = max(flows, key=lambda each: each.hertz)
    return f"{'~' if fastest.basis == 'assumed' else ''}{fastest.hertz:g}"


def call(report: CallReport) -> str:
    """Returns what a connection with a ROS service or action does, in a sentence."""
    messages, peers = ", ".join(report.messages), ", ".join(report.peers) or "anybody"
    what = f"{report.kind} {report.ros_name} ({report.type}) {WAYS[report.direction]}"
    return f"{report.name}: {what}; {messages}; {peers}; an answer within {report.seconds:g} s"


def kilobytes(octets: float) -> str:
    """Returns bytes in thousands, with three digits."""
    return number(octets / 1000)


def number(value: float) -> str:
    """Returns a number with three digits, without an exponent."""
    if value == 0:
        return "0"
    digits = 0 if value >= 100 else 1 if value >= 10 else 2
    return f"{value:.{digits}f}"


def time(budget: Budget) -> str:
    """Returns the sum of a budget."""
    return "no bound" if budget.seconds is None else f"{budget.seconds:.3f} s"


def steps(budget: Budget) -> str:
    """Returns the steps of a budget, or why it has no bound."""
    if budget.never:
        return budget.never
    named = (f"{each.name}: {each.seconds:.3f}" for each in budget.steps)
    return " + ".join(named) or "passed on at once"


def notes(assumptions: Assumptions) -> list[str]:
    """Returns what the figures stand on."""
    special = [
        *(f"{name} {value:g} Hz" for name, value in sorted(assumptions.rates.items())),
        *(f"{name} {value} elements" for name, value in sorted(assumptions.lengths.items())),
    ]
    return [
        f"~ is an assumed rate: {assumptions.rate:g} Hz where a model states none (--assume-rate).",
        f"Lists without a bound have {assumptions.length} elements (--assume-length); optional "
        "fields that may be there are. + after a size: nothing but the receiver limits it.",
        *([f"Assumed besides: {', '.join(special)}."] if special else []),
        "Bytes are those of UDP payload: the version byte, 14 bytes of header and number, the "
        "message; IP adds 28 to each datagram, and more where it cuts one; Ethernet 38 a frame.",
        "Sums have acknowledgements, renewals of events and control. Not in them: searches, "
        "registration, the start, calls of ROS services and actions, and what TCP adds.",
        "Times are worst cases of what the model decides; network and processors come on top.",
        "CPU is a share of one processor by the figures of a benchmark: it tells bridges apart.",
    ]
