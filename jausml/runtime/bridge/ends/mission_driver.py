"""The mission spooler of a bridge: has the mission of its controller executed by a connection.

AS6062, Mission Spooler: a mission is a tree of tasks with messages. These are executed like the
elements of a list: the messages of a task first, then those of its subtasks. One mission is kept at
a time. It is paused when its controller is lost, and goes on when it is resumed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum, IntEnum
from typing import Any

from ...base.address import JausAddress
from ...services.access_control import AccessControlService
from ...services.definitions import Completion, Guard, Status
from ...services.host import Host
from ...services.list_elements import ListElement
from ...services.list_manager import NO_UID
from ...services.management import ManagementService
from ...wire.message import Message
from .list_driver import ListDriver, ListExecutor, ListMessages


@dataclass(frozen=True)
class MissionMessages(ListMessages):
    """The messages of a mission spooler.

    `execute` is RunMission, `query` and `report` are QueryMissionStatus and ReportMissionStatus.
    """

    spool: type[Message]
    abort: type[Message]
    pause: type[Message]
    resume: type[Message]

    def driver(self, component: Host) -> MissionDriver:
        """Returns a new spooler for the missions of a component."""
        return MissionDriver(component, self)


class State(IntEnum):
    """State of a mission, of a task or of a message (ReportMissionStatus, Status)."""

    INIT = 0
    RUNNING = 1
    PAUSED = 3
    ABORTED = 5
    BLOCKED = 6
    FINISHED = 7


class Cause(IntEnum):
    """Why a mission is in its state (ReportMissionStatus, SecondaryStatus)."""

    NO_ERROR = 0
    LOST_CONTROL = 1
    INTERNAL_FAILURE = 3


class Kind(IntEnum):
    """Subject of a report (ReportMissionStatus, Type)."""

    MISSION = 0
    TASK = 1
    MESSAGE = 2


class MissionError(Enum):
    """Why a mission is not stored; the value is the name of the counter."""

    NOT_INIT = "mission.not_stored"
    NO_TREE = "mission.no_tree"
    NOT_FOR_US = "mission.other_destination"
    UNKNOWN_MESSAGE = "mission.unsupported_message"


@dataclass
class Mission:
    """A mission in the order in which it is executed.

    The place of a message is its index in that order, from 1; it is also the UID of its element.
    """

    number: int
    parent: JausAddress  # the component that spooled it, and is sent ReportMissionStatus
    elements: Sequence[ListElement]  # its messages
    names: Sequence[tuple[int, int]]  # task and UID of each message, which is unique in its task
    state: State = State.INIT
    cause: Cause = Cause.NO_ERROR
    first: int = 1  # place where RunMission began
    present: int = NO_UID  # place that is executed
    tasks: dict[int, int] = field(default_factory=dict)  # last place of each task

    def __post_init__(self) -> None:
        self.tasks = {task: place for place, (task, _) in enumerate(self.names, 1)}

    def place(self, task: int | None, uid: int | None) -> int:
        """Returns the first place of a task, or of one of its messages; 0 for an unknown one."""
        if task is None and uid is None:
            return 1
        for place, (own_task, own_uid) in enumerate(self.names, 1):
            if task in (None, own_task) and uid in (None, own_uid):
                return place
        return NO_UID

    def state_at(self, first: int, last: int) -> State:
        """Returns the common state of the messages of some places."""
        if last < self.first:
            return State.INIT
        if self.state is State.FINISHED or last < self.present:
            return State.FINISHED
        return self.state if first <= self.present else State.INIT


class MissionDriver(ListDriver):
    """Has the mission of a bridge executed, as its controller commands."""

    def __init__(self, component: Host, messages: MissionMessages) -> None:
        """Takes the commands of a mission spooler, and answers QueryMissionStatus."""
        super().__init__(component, messages)
        self._mission: Mission | None = None
        self._commander: JausAddress | None = None
        self._pause_behind = NO_UID
        for message, handler, guard in (
            (messages.spool, self._spool, Guard.CONTROLLED),
            (messages.abort, self._abort, Guard.CONTROLLED),
            (messages.pause, self._pause, Guard.READY),
            (messages.resume, self._resume, Guard.READY),
        ):
            component.handle(message, handler, when=guard)

    # ------------------------------------------------------------------ as a list driver

    def supports(self, element: ListElement) -> bool:  # noqa: ARG002
        """Returns False: elements of ListManager are no messages of a mission."""
        return False

    def list_changed(self) -> None:
        """Does nothing: the list of ListManager is not that of a mission."""

    def elements_from(self, uid: int) -> list[ListElement]:
        """Returns the messages from a place on."""
        return list(self._mission.elements[uid - 1 :]) if self._mission and uid else []

    @property
    def restart_uid(self) -> int:
        """0, as a mission is executed once."""
        return NO_UID

    def reached(self, executor: ListExecutor, uid: int) -> None:
        """Sets the present message, reports finished ones to the parent; pauses if that is due."""
        mission = self._mission
        if mission is None or not self.is_executed_by(executor):
            return
        former, mission.present = mission.present, max(uid, mission.present)
        for place in range(max(former, 1), mission.present):
            self._tell_parent(Kind.MESSAGE, mission.names[place - 1][1], State.FINISHED)
        super().reached(executor, mission.present)
        if self._pause_behind and mission.present > self._pause_behind:
            self._halt(executor)

    def finished(self, executor: ListExecutor, *, succeeded: bool) -> None:
        """Reports the end of the mission; if its controller is lost, it is paused instead."""
        mission = self._mission
        if mission is None or not self.is_executed_by(executor):
            return
        if succeeded:
            self._set_state(State.FINISHED)
            self._tell_parent(Kind.MESSAGE, mission.names[-1][1], State.FINISHED)
        elif mission.state is not State.ABORTED:
            if self._is_controlled():
                self._set_state(State.ABORTED, Cause.INTERNAL_FAILURE)
            else:
                self._set_state(State.PAUSED, Cause.LOST_CONTROL)
        super().finished(executor, succeeded=succeeded)
        self._tell_of_mission()

    def _is_controlled(self) -> bool:
        status = self._component.part(ManagementService).status
        controller = self._component.part(AccessControlService).controller
        return status == Status.READY and controller == self._commander

    def _element(self, uid: int) -> ListElement | None:
        return next(iter(self.elements_from(uid)), None)

    def _report(self, query: Any, _sender: JausAddress) -> Message | None:
        mission = self._mission
        if mission is None or query.mission_id not in (None, mission.number):
            return None
        if query.uid is None and query.task_id is None:
            return self._status(Kind.MISSION, mission.number, mission.state, mission.cause)
        first = mission.place(query.task_id, query.uid)
        if not first:
            return None
        if query.uid is not None:
            return self._status(Kind.MESSAGE, query.uid, mission.state_at(first, first))
        last = mission.tasks[query.task_id]
        return self._status(Kind.TASK, query.task_id, mission.state_at(first, last))

    # ------------------------------------------------------------------ messages

    def _spool(self, message: Any, sender: JausAddress) -> None:
        mission = self._read(message, sender)
        if isinstance(mission, MissionError):
            self._component.counters.count(mission.value, f"mission of {sender}")
            return
        self._mission = mission
        self._tell_of_mission()

    def _read(self, message: Any, sender: JausAddress) -> Mission | MissionError:
        former = self._mission
        if former is not None and former.state not in (State.ABORTED, State.FINISHED):
            return MissionError.NOT_INIT
        tasks = _in_order(message.mission_plan)
        pairs = [(task.task_data, data) for task in tasks for data in task.task_data.jaus_messages]
        if not pairs or len(tasks) < len(message.mission_plan):
            return MissionError.NO_TREE
        elements = [
            ListElement(place, data=task_message.jaus_message)
            for place, (_, task_message) in enumerate(pairs, 1)
        ]
        if not all(
            _is_for(self._component.address, task_message.destination_id)
            for _, task_message in pairs
        ):
            return MissionError.NOT_FOR_US
        if not all(super(MissionDriver, self).supports(element) for element in elements):
            return MissionError.UNKNOWN_MESSAGE
        names = [(task.task_info.task_id, task_message.uid) for task, task_message in pairs]
        return Mission(message.mission_info.mission_id, sender, elements, names)

    def _execute(self, message: Any, sender: JausAddress) -> Completion:
        """Executes the mission from its beginning, or from the task or message that is named."""
        mission = self._known(message.mission_id, State.INIT, State.PAUSED)
        place = NO_UID
        if mission is not None:
            place = mission.place(message.task_id, message.message_uid)
            mission.first = place or mission.first
        return self._go(place, sender)

    def _resume(self, message: Any, sender: JausAddress) -> Completion:
        """Executes the mission from where it was paused."""
        mission = self._known(message.mission_id, State.INIT, State.PAUSED)
        return self._go(NO_UID if mission is None else max(mission.present, 1), sender)

    def _go(self, place: int, sender: JausAddress) -> Completion:
        completion = Completion()
        executor = self._executor_of(self.elements_from(place), place, sender)
        if self._mission is None or executor is None:
            completion.fail()
            return completion
        self._completion.fail()
        self._mission.present = place
        self._pause_behind = NO_UID
        self._set_state(State.RUNNING)
        self._running, self._completion, self._commander = executor, completion, sender
        executor.begin(place, None)
        self._tell_of_mission()
        return completion

    def _pause(self, message: Any, _sender: JausAddress) -> None:
        """Pauses at once, or behind the task that is named."""
        mission = self._known(message.mission_id, State.RUNNING)
        if mission is None or self._running is None:
            return
        if message.task_id is None:
            self._halt(self._running)
        else:
            self._pause_behind = mission.tasks.get(message.task_id, NO_UID)

    def _halt(self, executor: ListExecutor) -> None:
        self._pause_behind = NO_UID
        self._set_state(State.PAUSED)
        executor.change_speed(0.0)
        self._tell_of_mission()

    def _abort(self, message: Any, _sender: JausAddress) -> None:
        mission = self._known(message.mission_id, State.INIT, State.RUNNING, State.PAUSED)
        if mission is None:
            return
        self._set_state(State.ABORTED)
        if self._running is not None:
            self._running.leave()
        else:
            self._tell_of_mission()

    def _known(self, number: int | None, *states: State) -> Mission | None:
        """Returns the mission of a number if it is in one of some states; else None, counted."""
        mission = self._mission
        if mission is not None and number in (None, mission.number) and mission.state in states:
            return mission
        self._component.counters.count("mission.not_there", f"mission {number} is not to be had")
        return None

    # ------------------------------------------------------------------ reports

    def _set_state(self, state: State, cause: Cause = Cause.NO_ERROR) -> None:
        if self._mission is not None:
            self._mission.state, self._mission.cause = state, cause

    def _tell_of_mission(self) -> None:
        mission = self._mission
        if mission is not None:
            self._tell_parent(Kind.MISSION, mission.number, mission.state, mission.cause)
            self._component.report_changed(self._messages.report)

    def _tell_parent(
        self, kind: Kind, number: int, state: State, cause: Cause = Cause.NO_ERROR
    ) -> None:
        if self._mission is not None:
            report = self._status(kind, number, state, cause)
            self._component.send(report, self._mission.parent, acknowledge=True)

    def _status(
        self, kind: Kind, number: int, state: State, cause: Cause = Cause.NO_ERROR
    ) -> Message:
        report: Any = self._messages.report
        message: Message = report(type_=kind, id_=number, status=state, secondary_status=cause)
        return message


def _in_order(tasks: Sequence[Any]) -> list[Any]:
    """Returns the tasks of a tree, each before its subtasks; fewer tasks if they are no tree."""
    children = [[sub_task.child_task_index for sub_task in task.sub_tasks] for task in tasks]
    subtasks = [index for indices in children for index in indices]
    if len(set(subtasks)) < len(subtasks) or any(index >= len(tasks) for index in subtasks):
        return []

    def walk(root: int) -> Iterator[Any]:
        waiting = [root]
        while waiting:
            index = waiting.pop()
            yield tasks[index]
            waiting += reversed(children[index])

    roots = (index for index in range(len(tasks)) if index not in set(subtasks))
    return [task for root in roots for task in walk(root)]


def _is_for(address: JausAddress, destination: Any) -> bool:
    """Returns whether a message of a mission is for a component, itself or by a wildcard."""
    return (
        destination.subsystem_id in (address.subsystem, 0xFFFF)
        and destination.node_id in (address.node, 0xFF)
        and destination.component_id in (address.component, 0xFF)
    )
