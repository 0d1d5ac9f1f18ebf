"""The list driver of a bridge: has the list of its controller executed by a connection.

AS6009, list drivers: ExecuteList begins at an element, or changes the speed when it names no
element; ReportActiveElement names the element that is executed, or 0. The list is that of
ListManager (AS5710). A component has one list, which its connections (executors) share: the kind of
its elements decides which one executes it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

from ...base.address import JausAddress
from ...services.definitions import Completion, Guard
from ...services.host import Host
from ...services.list_elements import ListElement
from ...services.list_manager import NO_UID, ListManagerService
from ...transports.delivery import MESSAGE_CODE_SIZE
from ...wire.message import Message


@dataclass(frozen=True)
class ListMessages:
    """The messages of a list driver."""

    execute: type[Message]  # ExecuteList; for manipulators it has no speed
    query: type[Message]
    report: type[Message]

    def driver(self, component: Host) -> ListDriver:
        """Returns a new driver for the lists of a component."""
        return ListDriver(component, self)


Answer = tuple["type[Message]", "type[Message]"]  # a query and its report


@dataclass(frozen=True)
class ListAnswers:
    """Further queries that a list driver answers for one kind of list.

    Attributes:
        speed: QueryTravelSpeed and ReportTravelSpeed; None if there are none.
        element: The query and the report of the active element, where the report has the fields of
            the element; None if there are none.
    """

    speed: Answer | None = None
    element: Answer | None = None


class ListExecutor(Protocol):
    """A connection that executes lists of one kind of elements."""

    def obeys(self, sender: JausAddress) -> bool:
        """Returns whether a sender may have lists executed."""

    def is_of(self, element: ListElement) -> bool:
        """Returns whether an element is of its kind."""

    def can_carry(self, element: ListElement) -> bool:
        """Returns whether an element of its kind can be executed."""

    def begin(self, uid: int, speed: float | None) -> None:
        """Executes the list from an element on, at a speed in m/s if the driver has one."""

    def change_speed(self, speed: float) -> None:
        """Goes on at another speed in m/s; 0 stops, also for a driver without speed."""

    def list_changed(self) -> None:
        """Takes over a change of the list that is executed."""

    def leave(self) -> None:
        """Ends the execution, in favour of another executor."""


class ListDriver:
    """Has the list of a bridge executed, as its controller commands."""

    def __init__(self, component: Host, messages: ListMessages) -> None:
        """Takes ExecuteList and answers QueryActiveElement."""
        self.active = NO_UID  # UID of the element that is executed; 0 for none
        self.speed = 0.0  # commanded, in m/s; 0 for none
        self._component = component
        self._list = component.part(ListManagerService)
        self._list.drivers.append(self)
        self._messages = messages
        self._executors: list[ListExecutor] = []
        self._running: ListExecutor | None = None
        self._reports: list[type[Message]] = []  # that change with the element and the speed
        self._last: dict[ListExecutor, ListElement] = {}  # active ones
        self._completion = Completion()
        component.handle(messages.execute, self._execute, when=Guard.READY)
        component.provide(messages.query, messages.report, self._report)

    def add(self, executor: ListExecutor, answers: ListAnswers) -> None:
        """Adds an executor for one more kind of list, and the answers for that kind."""
        self._executors.append(executor)
        if answers.speed is not None:
            self._provide(answers.speed, partial(self._report_speed, answers.speed[1]))
        if answers.element is not None:
            provider = partial(self._report_element, executor, answers.element[1].CODE)
            self._provide(answers.element, provider)

    def _provide(self, answer: Answer, provider: Callable[[Message, JausAddress], Any]) -> None:
        # Executors of two kinds share the report of the speed.
        if answer[1] not in self._reports:
            self._component.provide(*answer, provider)
            self._reports.append(answer[1])

    # ------------------------------------------------------------------ for the bridge

    def supports(self, element: ListElement) -> bool:
        """Returns whether the list may hold an element, as an executor can execute it."""
        return any(
            executor.is_of(element) and executor.can_carry(element) for executor in self._executors
        )

    def list_changed(self) -> None:
        """Takes over a change of the list."""
        if self._running is not None:
            self._keep_active()
            self._running.list_changed()
            self._update_reports()

    # ------------------------------------------------------------------ for the executors

    def is_executed_by(self, executor: ListExecutor) -> bool:
        """Returns whether an executor executes the list now."""
        return self._running is executor

    def elements_from(self, uid: int) -> list[ListElement]:
        """Returns the elements from the one with a UID on; none if there is no such element."""
        elements = list(self._list.elements)
        uids = [element.uid for element in elements]
        return elements[uids.index(uid) :] if uid in uids else []

    @property
    def restart_uid(self) -> int:
        """UID of the first element of a circular list; 0 for another list."""
        elements = self._list.elements
        return elements.first.uid if elements.circular and elements.first else NO_UID

    def reached(self, executor: ListExecutor, uid: int) -> None:
        """Sets the element that an executor executes now."""
        if self._running is executor:
            self._set_active(uid)

    def finished(self, executor: ListExecutor, *, succeeded: bool) -> None:
        """Ends the execution of the list by an executor."""
        if self._running is not executor:
            return
        self._running = None
        # The outcome is known before ReportActiveElement tells that the list has ended.
        if succeeded:
            self._completion.succeed()
        else:
            self._completion.fail()
        self.speed = 0.0
        self._set_active(NO_UID)
        self._update_reports()

    # ------------------------------------------------------------------ messages

    def _execute(self, message: Any, sender: JausAddress) -> Completion:
        """Executes the list from an element on; without an element, changes the speed (AS6009)."""
        speed: float | None = getattr(message, "speed", None)
        if message.element_uid is None and speed is not None:
            return self._change_speed(speed)
        completion = Completion()
        uid = message.element_uid or getattr(self._list.elements.first, "uid", NO_UID)
        elements = self.elements_from(uid)
        executor = self._executor_of(elements, uid, sender)
        if executor is None:
            completion.fail()
            return completion
        self._take_over(executor, completion)
        self.speed = speed or 0.0
        executor.begin(uid, speed)
        self._update_reports()
        return completion

    def _take_over(self, executor: ListExecutor, completion: Completion) -> None:
        """Makes an executor the running one for a new command; the command before it fails."""
        self._completion.fail()
        former = self._running
        if former is not None and former is not executor:
            former.leave()
        self._running, self._completion = executor, completion

    def _change_speed(self, speed: float) -> Completion:
        if self._running is not None:
            self.speed = speed
            self._running.change_speed(speed)
            self._update_reports()
        completion = Completion()
        completion.succeed()
        return completion

    def _executor_of(
        self, elements: list[ListElement], uid: int, sender: JausAddress
    ) -> ListExecutor | None:
        """Returns the executor for elements; None if there is none, which is counted."""
        counters = self._component.counters
        if not elements:
            counters.count("list_driver.unknown_element", f"{sender} wants element {uid} executed")
            return None
        for executor in self._executors:
            if all(map(executor.is_of, elements)):
                if executor.obeys(sender):
                    return executor
                counters.count("list_driver.unexpected_source", f"list of {sender}")
                return None
        counters.count("list_driver.mixed_list", f"the list of {sender} has elements of two kinds")
        return None

    def _report(self, _query: Message, _sender: JausAddress) -> Message | bytes | None:
        report: Any = self._messages.report
        message: Message = report(element_uid=self.active)
        return message

    def _report_speed(self, report: Any, _query: Message, _sender: JausAddress) -> Message:
        message: Message = report(speed=self.speed)
        return message

    def _report_element(
        self, executor: ListExecutor, code: int, _query: Message, _sender: JausAddress
    ) -> bytes | None:
        """Returns the report of the element that is or was active, else of the first of the list.

        None when that is not of the kind of the executor, or there is none.
        """
        first = self._list.elements.first
        element = self._last.get(executor) or first
        if element is None or not executor.is_of(element):
            return None
        return self._report_of(code, element)

    @staticmethod
    def _report_of(code: int, element: ListElement) -> bytes:
        """Returns the report of an element: a code and the fields of the element."""
        return code.to_bytes(MESSAGE_CODE_SIZE, "little") + element.data[MESSAGE_CODE_SIZE:]

    def _set_active(self, uid: int) -> None:
        if uid != self.active:
            self.active = uid
            self._keep_active()
            self._component.report_changed(self._messages.report)
            self._update_reports()

    def _keep_active(self) -> None:
        element = self._element(self.active)
        if self._running is not None and element is not None:
            self._last[self._running] = element

    def _element(self, uid: int) -> ListElement | None:
        return self._list.elements.get(uid)

    def _update_reports(self) -> None:
        for report in self._reports:
            self._component.report_changed(report)
