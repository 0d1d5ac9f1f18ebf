"""What a component does in place of methods that nobody has written: it keeps what it is told."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, TypeVar

from ..wire.message import Message

if TYPE_CHECKING:
    from .component import JausComponent

LOGGER = logging.getLogger(__name__)

MessageT = TypeVar("MessageT", bound=Message)


class Simulation:
    """Keeps what a component is told, and makes its reports of it.

    Components that the model calls ``simulated`` have one: nothing is behind them yet, and each
    Report says what the Set of the same quantity asked for (AS6009). Nothing has measured that:
    every report is counted as ``component.simulated``, and a component says so when it begins.
    """

    def __init__(self, component: JausComponent) -> None:
        """Has been told nothing yet."""
        self._component = component
        self._kept: dict[type[Message], dict[str, Any]] = {}
        component.when_started(self._warn)

    def keep(self, report_class: type[Message], **values: Any) -> None:
        """Have reports say these values from now on, and send events on them.

        Args:
            values: By their attributes in the report. None is what a command left out: of that, the
                value before stays.
        """
        told = {name: value for name, value in values.items() if value is not None}
        self._kept.setdefault(report_class, {}).update(told)
        self._component.report_changed(report_class)

    def report(self, at_rest: MessageT) -> MessageT:
        """Return a report that says what was kept, and of all else what it says at rest.

        Args:
            at_rest: The report of a component that was told nothing; it is changed.
        """
        for name, value in self._kept.get(type(at_rest), {}).items():
            setattr(at_rest, name, value)
        self._component.counters.add("component.simulated")
        return at_rest

    def _warn(self) -> None:
        LOGGER.warning(
            "%s is simulated: its reports say what it was told, and nothing of a machine",
            self._component.address,
        )
