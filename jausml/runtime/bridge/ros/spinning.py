"""Nodes of ROS that are no bridges: they spin until a signal ends them."""

from __future__ import annotations

import atexit
import signal
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import rclpy
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.utilities import ok, try_shutdown

from ...base.process import ignore_signals
from ..ends.topics import ParameterError
from .parameters import as_parameter_error, tell_unknown

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

WAKE_UP_PERIOD = 1.0  # longest time in seconds until a node that spins notices a shutdown


def spin(factory: Callable[[], Any], arguments: Sequence[str] | None) -> None:
    """Spins a node until SIGINT or SIGTERM; a wrong parameter is a ParameterError."""
    atexit.register(ignore_signals)
    # ROS itself ends on a signal; Python's KeyboardInterrupt would strike anywhere, even in
    # clean-up. What comes before ROS has begun is not forgotten.
    early: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: early.append(number))
    with as_parameter_error():
        rclpy.init(args=None if arguments is None else list(arguments))
    try:
        if early:
            return
        node = _new_node(factory)
        tell_unknown(node)
        # rclpy may begin to wait just after a signal has shut ROS down; nothing else wakes it then.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(WAKE_UP_PERIOD, lambda: None, clock=steady)
        with suppress(ExternalShutdownException):
            rclpy.spin(node)
        node.destroy_node()
    except RuntimeError:
        # A signal shuts ROS down in the midst of anything, which rclpy may report like this.
        if ok():
            raise
    finally:
        try_shutdown()


def _new_node(factory: Callable[[], Any]) -> Any:
    """Makes a node; errors of the user's code stay as they are."""
    try:
        return factory()
    except ParameterException as error:
        raise ParameterError(" ".join(str(error).split())) from error
