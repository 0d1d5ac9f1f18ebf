"""Process of one ROS 2 node that is no bridge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..base.counters import LOGGER
from ..base.process import EXIT_OK, EXIT_USAGE
from .ends.topics import ParameterError
from .ros.environment import permits_ros


def run_node(factory: Callable[[], object], arguments: Sequence[str] | None = None) -> int:
    """Spins a ROS 2 node until SIGINT or SIGTERM.

    Args:
        arguments: Command line without the program's name, with --ros-args; that of the process
            when None.

    Returns:
        The exit code: 0, or 2 when a parameter or the environment does not allow the node.
    """
    if not permits_ros("the node"):
        return EXIT_USAGE
    from .ros.spinning import spin  # noqa: PLC0415

    try:
        spin(factory, arguments)
    except ParameterError as error:
        LOGGER.error("the node cannot run: %s", error)
        return EXIT_USAGE
    return EXIT_OK
