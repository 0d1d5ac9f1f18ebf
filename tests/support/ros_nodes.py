"""Nodes of ROS that run beside a test. Their functions need rclpy."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing_extensions import Self


class SpinningNode:
    """A node in a context of its own, whose callbacks come on a thread from `start` on.

    Used with `with`, it starts and ends by itself.
    """

    def __init__(self, name: str, namespace: str = "", executor: Any = None) -> None:
        """Joins ROS in the domain of the environment.

        Args:
            executor: Class of what runs the callbacks; without one `EndableExecutor`.
        """
        import rclpy

        from jausml.runtime.bridge.ros.lifecycle import EndableExecutor

        self.context = rclpy.Context()
        rclpy.init(context=self.context, args=[])
        self.node = rclpy.create_node(name, namespace=namespace, context=self.context)
        self.executor = (executor or EndableExecutor)(self.context)
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)

    def start(self) -> Self:
        """Lets callbacks come."""
        self.executor.add_node(self.node)
        self._thread.start()
        return self

    @property
    def spins(self) -> bool:
        """Whether callbacks come."""
        return self._thread.is_alive()

    def close(self) -> None:
        """Leaves ROS, once no callback runs any more."""
        self.executor.end()
        if self.spins:
            self._thread.join()
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _spin(self) -> None:
        from rclpy.executors import ExternalShutdownException

        try:
            self.executor.spin()
        except ExternalShutdownException:
            return
