"""Runs ROS nodes that are no bridges until a signal ends them."""

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
from .parameters import as_parameter_error, warn_of_unknown

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

WAKE_UP_PERIOD = 1.0  # longest time in seconds until a node that spins notices a shutdown


def spin(factory: Callable[[], Any], arguments: Sequence[str] | None) -> None:
    """Spins a node until SIGINT or SIGTERM; raises ParameterError for a wrong parameter."""
    atexit.register(ignore_signals)
    # rclpy handles signals once it runs. Earlier ones are kept, as a KeyboardInterrupt might come
    # anywhere, even in clean-up.
    early_signals: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _: early_signals.append(number))
    with as_parameter_error():
        rclpy.init(args=None if arguments is None else list(arguments))
    try:
        if early_signals:
            return
        node = _new_node(factory)
        warn_of_unknown(node)
        # Wakes an rclpy that began to wait just after a signal has shut ROS down.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(WAKE_UP_PERIOD, lambda: None, clock=steady)
        with suppress(ExternalShutdownException):
            rclpy.spin(node)
        node.destroy_node()
    except RuntimeError:
        # rclpy may raise this wherever a signal shuts ROS down.
        if ok():
            raise
    finally:
        try_shutdown()


def _new_node(factory: Callable[[], Any]) -> Any:
    """Makes a node; raises ParameterError for errors of parameters."""
    try:
        return factory()
    except ParameterException as error:
        raise ParameterError(" ".join(str(error).split())) from error
