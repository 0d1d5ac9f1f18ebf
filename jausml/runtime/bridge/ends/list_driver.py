"""The list driver that a bridge provides: the list of its controller, and who executes it.

AS6009, list drivers: ExecuteList begins at an element, or changes the speed when it names none;
ReportActiveElement names the element that is executed, or 0. The list is that of ListManager
(AS5710). A component has one list, so its drivers share it: the kind of its elements says whose it
is.
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

    execute: type[Message]  # that of manipulators has no speed
    query: type[Message]
    report: type[Message]

    def driver(self, component: Host) -> ListDriver:
        """Returns the driver of a component that executes its lists."""
        return ListDriver(component, self)


Answer = tuple["type[Message]", "type[Message]"]  # a query and its report


@dataclass(frozen=True)
class ListAnswers:
    """What a list driver tells of one kind of list besides the active element.

    Attributes:
        speed: QueryTravelSpeed and ReportTravelSpeed; None for a driver that tells none.
        element: The query and the report of what the active element holds, laid out as that is;
            None for a driver that does not tell it.
    """

    speed: Answer | None = None
    element: Answer | None = None


class ListExecutor(Protocol):
    """Whoever executes lists of one kind of elements."""

    def obeys(self, sender: JausAddress) -> bool:
        """Whether a controller may have lists executed."""

    def is_of(self, element: ListElement) -> bool:
        """Whether an element is of the kind."""

    def can_carry(self, element: ListElement) -> bool:
        """Whether an element of the kind says something that can be executed."""

    def begin(self, uid: int, speed: float | None) -> None:
        """Executes the list from an element on, in m/s; None for a driver that knows no speed."""

    def change_speed(self, speed: float) -> None:
        """Goes on at another speed; 0 stands still, also for a driver that knows none."""

    def list_changed(self) -> None:
        """Follows a change of the list that is executed."""

    def leave(self) -> None:
        """Ends what is executed: another kind of list is."""


class ListDriver:
    """Executes the list of a bridge, as its controller says."""

    def __init__(self, component: Host, messages: ListMessages) -> None:
        """Takes ExecuteList and answers QueryActiveElement."""
        self.active = NO_UID  # UID of the element that is executed; 0 for none
        self.speed = 0.0  # m/s, as its controller has said; 0 for none
        self._component = component
        self._list = component.part(ListManagerService)
        self._list.drivers.append(self)
        self._messages = messages
        self._executors: list[ListExecutor] = []
        self._running: ListExecutor | None = None
        self._reports: list[type[Message]] = []  # what changes with the element and the speed
        self._last: dict[ListExecutor, ListElement] = {}  # what was active last
        self._completion = Completion()
        component.handle(messages.execute, self._execute, when=Guard.READY)
        component.provide(messages.query, messages.report, self._report)

    def add(self, executor: ListExecutor, answers: ListAnswers) -> None:
        """Has lists of one more kind executed, and tells of them what is asked."""
        self._executors.append(executor)
        if answers.speed is not None:
            self._provide(answers.speed, partial(self._report_speed, answers.speed[1]))
        if answers.element is not None:
            of_kind = partial(self._report_element, executor, answers.element[1].CODE)
            self._provide(answers.element, of_kind)

    def _provide(self, answer: Answer, provider: Callable[[Message, JausAddress], Any]) -> None:
        # Drivers of two kinds tell the same speed.
        if answer[1] not in self._reports:
            self._component.provide(*answer, provider)
            self._reports.append(answer[1])

    # ------------------------------------------------------------------ for the bridge

    def supports(self, element: ListElement) -> bool:
        """Whether the list may hold an element: somebody can execute it."""
        return any(
            executor.is_of(element) and executor.can_carry(element) for executor in self._executors
        )

    def list_changed(self) -> None:
        """Follows a change of the list."""
        if self._running is not None:
            self._note_active()
            self._running.list_changed()
            self._tell()

    # ------------------------------------------------------------------ for the executors

    def is_executed_by(self, executor: ListExecutor) -> bool:
        """Whether an executor executes the list now."""
        return self._running is executor

    def elements_from(self, uid: int) -> list[ListElement]:
        """Returns the elements from one on, in their order; none when it is not there."""
        elements = list(self._list.elements)
        start = next(
            (at for at, element in enumerate(elements) if element.uid == uid), len(elements)
        )
        return elements[start:]

    @property
    def first_again(self) -> int:
        """UID of the first element if it follows the last one; 0 if it does not."""
        elements = self._list.elements
        return elements.first.uid if elements.circular and elements.first else NO_UID

    def reached(self, executor: ListExecutor, uid: int) -> None:
        """Notes which element is executed."""
        if self._running is executor:
            self._set_active(uid)

    def finished(self, executor: ListExecutor, *, succeeded: bool) -> None:
        """Notes that the list is not executed any more."""
        if self._running is not executor:
            return
        self._running = None
        # Whoever waits for the end learns how it was before the active element tells that it is.
        if succeeded:
            self._completion.succeed()
        else:
            self._completion.fail()
        self.speed = 0.0
        self._set_active(NO_UID)
        self._tell()

    # ------------------------------------------------------------------ messages

    def _execute(self, message: Any, sender: JausAddress) -> Completion:
        """Begins at an element, or changes the speed when none is named (AS6009, ExecuteList)."""
        speed: float | None = getattr(message, "speed", None)
        if message.element_uid is None and speed is not None:
            return self._change_speed(speed)
        begun = Completion()
        uid = message.element_uid or getattr(self._list.elements.first, "uid", NO_UID)
        elements = self.elements_from(uid)
        executor = self._executor_of(elements, uid, sender)
        if executor is None:
            begun.fail()
            return begun
        self._take_over(executor, begun)
        self.speed = speed or 0.0
        executor.begin(uid, speed)
        self._tell()
        return begun

    def _take_over(self, executor: ListExecutor, begun: Completion) -> None:
        """Has an executor execute what a command says; the command before it has failed."""
        self._completion.fail()
        former = self._running
        if former is not None and former is not executor:
            former.leave()
        self._running, self._completion = executor, begun

    def _change_speed(self, speed: float) -> Completion:
        if self._running is not None:
            self.speed = speed
            self._running.change_speed(speed)
            self._tell()
        done = Completion()
        done.succeed()
        return done

    def _executor_of(
        self, elements: list[ListElement], uid: int, sender: JausAddress
    ) -> ListExecutor | None:
        """Returns who executes these elements; None, counted, when nobody does."""
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
        """Returns the active element; else the last one, or the one that a list begins with.

        None when there never was one of the kind: a place that nobody has said is no answer.
        """
        first = self._list.elements.first
        element = self._last.get(executor) or first
        if element is None or not executor.is_of(element):
            return None
        return self._told_as(code, element)

    @staticmethod
    def _told_as(code: int, element: ListElement) -> bytes:
        """Returns the report of an element, which is laid out as that is."""
        return code.to_bytes(MESSAGE_CODE_SIZE, "little") + element.data[MESSAGE_CODE_SIZE:]

    def _set_active(self, uid: int) -> None:
        if uid != self.active:
            self.active = uid
            self._note_active()
            self._component.report_changed(self._messages.report)
            self._tell()

    def _note_active(self) -> None:
        element = self._element(self.active)
        if self._running is not None and element is not None:
            self._last[self._running] = element

    def _element(self, uid: int) -> ListElement | None:
        return self._list.elements.get(uid)

    def _tell(self) -> None:
        for report in self._reports:
            self._component.report_changed(report)
