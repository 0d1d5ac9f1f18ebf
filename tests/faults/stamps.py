"""Values that say when they were sent, so that whoever gets one knows how old it is.

A value is a monotonic time, the same for all processes of a computer, folded into a range that
every field on the way carries; 0 is a stop.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml_runtime import JausComponent

ACCOUNT_PERIOD = 0.1
"""Seconds from one account to the next."""

FOLD = 90.0
"""Seconds after which values come again."""

_EARLY = 1.0
_LEAST = 0.5
"""Below it a value is a stop: fields have a step, which need not fall on 0."""

_OUTPUT = threading.Lock()


def stamp() -> float:
    """Returns a value that is sent now."""
    return 1.0 + time.monotonic() % FOLD


def age(value: float, at: float) -> float:
    """Returns how old a value was in seconds when it arrived.

    Args:
        value: What `stamp` gave, as exact as the fields on the way are.
        at: When it arrived, by the monotonic clock.
    """
    return (at - (value - 1.0) + _EARLY) % FOLD - _EARLY


def say_counts(peer: object, own: object, counts: dict[str, int]) -> None:
    """Tells the test what a component says of what came from a peer."""
    with _OUTPUT:
        fact = {"kind": "account", "pair": f"{peer} to {own}", "at": time.monotonic(), **counts}
        sys.stdout.write(json.dumps(fact) + "\n")


def say_connection(name: str, values: dict[str, str]) -> None:
    """Tells the test what a connection of the bridge says of its messages."""
    with _OUTPUT:
        counts = {key: int(value) for key, value in values.items() if value.isdecimal()}
        fact = {"kind": "connection", "name": name, "at": time.monotonic(), "counts": counts}
        sys.stdout.write(json.dumps(fact) + "\n")


def say_accounts(component: JausComponent) -> None:
    """Tells the test again and again what a component says of what came from its peers."""
    from jausml_runtime.transports.transport import accounts_of  # ROS nodes have no runtime

    component.loop.call_later(ACCOUNT_PERIOD, lambda: say_accounts(component))
    for account in accounts_of(component):
        say_counts(account.traffic.peer, component.address, account.counts())


def say(kind: str, value: float, **more: object) -> None:
    """Tells the test of an arrival; 0 is a stop."""
    told = value if value > _LEAST else 0.0
    with _OUTPUT:
        fact = {"kind": kind, "value": told, "at": time.monotonic(), **more}
        sys.stdout.write(json.dumps(fact) + "\n")
