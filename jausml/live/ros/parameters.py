"""Parameters of nodes, as far as they are wanted. Needs rclpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from threading import Condition

_MOST = 200
"""Parameters of a node that are read."""


class ParameterReader:
    """Asks nodes for their parameters.

    Attributes:
        found: Values by name, by the full name of the node.
    """

    def __init__(
        self, node: Any, nodes: Iterable[str], is_wanted: Callable[[str], bool], come: Condition
    ) -> None:
        """Prepares to ask.

        Args:
            come: Told of each node that has answered.
        """
        from rcl_interfaces.srv import GetParameters, ListParameters  # noqa: PLC0415

        self.found: dict[str, dict[str, Any]] = {}
        self._is_wanted = is_wanted
        self._come = come
        self._get = GetParameters.Request
        self._list = ListParameters.Request
        self._waiting = {
            each: (
                node.create_client(ListParameters, f"{each}/list_parameters"),
                node.create_client(GetParameters, f"{each}/get_parameters"),
            )
            for each in nodes
        }
        self._asked: set[str] = set()

    @property
    def unread(self) -> tuple[str, ...]:
        """The nodes that have not answered yet."""
        return tuple(sorted(self._waiting))

    def ask(self) -> None:
        """Asks the nodes whose services are there by now and that were not asked before."""
        for name, (lists, gets) in list(self._waiting.items()):
            if name not in self._asked and lists.service_is_ready() and gets.service_is_ready():
                self._asked.add(name)
                listed = lists.call_async(self._list())
                listed.add_done_callback(lambda done, of=name: self._listed(of, done.result()))

    def _listed(self, name: str, answer: Any) -> None:
        wanted = [each for each in answer.result.names if self._is_wanted(each)][:_MOST]
        if not wanted:
            self._note(name, {})
            return
        got = self._waiting[name][1].call_async(self._get(names=wanted))
        got.add_done_callback(lambda done: self._got(name, wanted, done.result()))

    def _got(self, name: str, wanted: list[str], answer: Any) -> None:
        from rclpy.parameter import parameter_value_to_python  # noqa: PLC0415

        values = map(parameter_value_to_python, answer.values)
        self._note(name, {n: v for n, v in zip(wanted, values, strict=False) if v is not None})

    def _note(self, name: str, values: dict[str, Any]) -> None:
        with self._come:
            if values:
                self.found[name] = values
            del self._waiting[name]
            self._come.notify_all()
