"""Drives along lists in virtual time: the generated processes, and stand-ins of the ROS nodes.

The operator is that of the example, the robot of J too. In R the bridge is the generated one; the
follower and the wheels are stand-ins that use the same laws. Equal seeds give equal drives.
"""

from __future__ import annotations

import math
import random
import struct
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from driving import PERIOD, Body, Course

from experiments.right_turn.loops import FAILURES, HOP, ROS_HOP, START, START_SPREAD
from experiments.right_turn.standins import Ros, StandIn

from .drives import LIMIT, WATCHED
from .results import Event, State, judge

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from experiments.right_turn.generated import Workspace

    from .drives import Drive
    from .results import Result

PATIENCE = 0.5
"""Seconds after the last command when the wheels stop."""
FRAME = "odom"
"""The only frame that the follower knows."""
COMMAND = "geometry_msgs/msg/Twist"
"""Type of what the follower commands; the bridge has no class for it."""
_TWIST = struct.Struct("<4s6d")


@dataclass(frozen=True)
class Conditions:
    """What a drive meets.

    Attributes:
        system: `J` or `R`.
        seed: Seed of the network and of the phases between the processes.
        parameters: ROS parameters of the bridge.
        broken: Makes a bridge with a mistake of the class of the bridge.
        late: Seconds by which each odometry comes later to the follower.
        is_deaf: Whether the follower goes on though its goal is canceled.
    """

    system: str = "R"
    seed: int = 1
    parameters: Mapping[str, Any] = field(default_factory=dict)
    broken: Callable[[Any], Any] | None = None
    late: float = 0.0
    is_deaf: bool = False


@dataclass
class Record:
    """What is seen of a drive."""

    truth: list[State] = field(default_factory=list)
    told: list[Event] = field(default_factory=list)

    def note_body(self, now: float, body: Body) -> None:
        """Notes the true state."""
        self.truth.append(State(now, body.x, body.y, body.speed))

    def count(self, kind: str) -> int:
        """Returns how often something was told."""
        return sum(each.kind == kind for each in self.told)


class Wheels(StandIn):
    """The node `wheels`."""

    def __init__(self, ros: Ros, record: Record) -> None:
        """Begins to listen and to move."""
        super().__init__(ros)
        self._body, self._wanted, self._record = Body(), (0.0, 0.0), record
        self._now = self._commanded = ros.world.now()
        ros.world.ros.subscribe("/robot/cmd_vel", COMMAND, self._on_command, link=ros.link)
        self._step()

    def _on_command(self, data: bytes) -> None:
        _, forward, *_, turn = _TWIST.unpack(data)
        self._wanted, self._commanded = (forward, turn), self._ros.world.now()

    def _step(self) -> None:
        world, body = self._ros.world, self._body
        world.call_later(PERIOD, self._step)
        now = world.now()
        body.advance(
            *(self._wanted if now - self._commanded < PATIENCE else (0, 0)), now - self._now
        )
        self._now = now
        self._record.note_body(now, body)
        odometry = self._types.Odometry()
        position, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        position.x, position.y = body.x, body.y
        turn.z, turn.w = math.sin(body.psi / 2), math.cos(body.psi / 2)
        seconds = world.utc().timestamp()
        odometry.header.stamp = self._types.Time(int(seconds), int(seconds % 1 * 1e9))
        self._say("/robot/odom", odometry)


class Follower(StandIn):
    """The node `follower`: serves the action, one goal at a time."""

    def __init__(self, ros: Ros, conditions: Conditions, outcome: Any) -> None:
        """Waits for goals; `outcome` is what names their ends."""
        super().__init__(ros)
        self._conditions = conditions
        self._goal: Any = None
        self._course = Course([])
        self._told = -1
        self._outcome = outcome
        self._listen("/robot/odom", ros.types.Odometry, self._on_odometry, ros.sensing)
        ros.world.ros.serve_action("/robot/follow_waypoints", self)

    def accepts(self, _elements: list[bytes], _request: Any) -> bool:
        """Accepts all."""
        return True

    def begin(self, goal: Any) -> None:
        """Begins with the first waypoint."""
        poses = [self._types.PoseStamped.from_cdr(each) for each in goal.elements]
        for frame in {each.header.frame_id for each in poses} - {FRAME}:
            goal.end(self._outcome.ABORTED, f"no transform from {frame} to {FRAME}")
            return
        self._course = Course([(each.pose.position.x, each.pose.position.y) for each in poses])
        self._goal, self._told = goal, -1
        self._tell()

    def cancel(self, goal: Any) -> None:
        """Stops, unless it hears nothing."""
        if goal is self._goal and not self._conditions.is_deaf:
            self._end(self._outcome.CANCELED, "canceled")

    def _on_odometry(self, odometry: Any) -> None:
        position, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        pose = (position.x, position.y, 2 * math.atan2(turn.z, turn.w))
        self._ros.world.call_later(self._conditions.late, partial(self._follow, pose))

    def _follow(self, pose: tuple[float, float, float]) -> None:
        if self._goal is None:
            return
        self._command(*self._course.command(*pose))
        if self._course.is_over:
            self._end(self._outcome.SUCCEEDED, "")
        else:
            self._tell()

    def _tell(self) -> None:
        if self._course.active != self._told:
            self._told = self._course.active
            self._goal.progress(self._told)

    def _end(self, outcome: Any, reason: str) -> None:
        goal, self._goal = self._goal, None
        self._command(0.0, 0.0)
        goal.end(outcome, reason)

    def _command(self, forward: float, turn: float) -> None:
        data = _TWIST.pack(b"\0\1\0\0", forward, 0.0, 0.0, 0.0, 0.0, turn)
        self._ros.world.ros.publish("/robot/cmd_vel", COMMAND, data)


def _observed_operator(operator: Any, record: Record) -> Any:
    """Returns the class of the operator, seen by a record."""

    class ObservedOperator(operator):  # type: ignore[misc] - known when it runs
        def _note(self, event: str, value: Any = 0, x: Any = math.nan, y: Any = math.nan) -> None:
            record.told.append(Event(event, self.clock.now(), int(value or 0), x, y))

    return ObservedOperator


def _observed_robot(robot: Any, record: Record) -> Any:
    """Returns the class of the robot of J, seen by a record."""

    class ObservedRobot(robot):  # type: ignore[misc] - known when it runs
        def _note(self, now: float, body: Body) -> None:
            record.note_body(now, body)

    return ObservedRobot


class VirtualDrive:
    """A system in a virtual world of its own."""

    def __init__(self, drive: Drive, conditions: Conditions, workspace: Workspace) -> None:
        """Makes the processes; none has started.

        Args:
            workspace: Generated code of its system.
        """
        self._virtual = workspace.module("jausml_runtime.virtual")
        self._drive, self._conditions, self._workspace = drive, conditions, workspace
        self.world = self._virtual.VirtualWorld(seed=conditions.seed, start=START)
        self.record = Record()
        link = self._virtual.Link(**HOP)
        self.radio = self.world.transport(out=link, into=link)
        self._robot_transport = self.world.transport()

    def run(self) -> Result:
        """Drives along the list, and judges it.

        Raises:
            RuntimeError: Code of a process has failed: what was seen would mean nothing.
            ValueError: The list was never executed.
        """
        self._start()
        world, record, drive = self.world, self.record, self._drive
        if drive.lost_at is not None:
            self._run_until(lambda: self._is_active(drive.lost_at))
            world.run_for(1.0)
            record.told.append(Event("lost", world.now(), 0))
            self.radio.cut()
            world.run_for(drive.stops_in + WATCHED)
        else:
            self._run_until(lambda: record.count("ended"))
            world.run_for(WATCHED if drive.emergency_at is not None else 0.5)
        counted = world.counters.snapshot()
        failed = {each: counted[each] for each in FAILURES if each in counted}
        world.close()
        if failed:
            raise RuntimeError(f"{drive.name}: code has failed in virtual time: {failed}")
        return judge(drive, record.truth, record.told)

    def _is_active(self, number: int) -> bool:
        return any(each.kind == "active" and each.value == number for each in self.record.told)

    def _run_until(self, condition: Callable[[], object]) -> None:
        """Lets time pass until something holds, or for as long as a list may take."""
        while not condition() and self.world.now() < LIMIT:
            self.world.run_for(0.25)

    def _start(self) -> None:
        """Starts the processes, one after the other, each at a time of its own."""
        chance = random.Random(f"phases of {self._conditions.seed}")
        starts = [self._start_operator, self._start_robot]
        chance.shuffle(starts)
        for start in starts:
            self.world.run_for(chance.uniform(0.0, START_SPREAD))
            start()

    def _start_operator(self) -> None:
        module = self._workspace.module("operator_unit.operator_unit")
        operator = _observed_operator(module.OperatorUnit, self.record)(self.radio)
        operator._plan = module.Plan(**self._drive.plan)  # noqa: SLF001 - else read from a file
        operator.start()

    def _start_robot(self) -> None:
        module = self._workspace.module("robot.robot")
        if self._conditions.system == "J":
            _observed_robot(module.Robot, self.record)(self._robot_transport).start()
            return
        link = self._virtual.Link(delay=ROS_HOP)
        node = self.world.ros_node(
            "robot", self._conditions.parameters, namespace="robot", link=link
        )
        broken = self._conditions.broken
        bridge = module.Robot() if broken is None else broken(module.Robot)()
        bridge.open(node, self._robot_transport)
        quality = self._workspace.module("jausml_runtime").Qos
        types = self._workspace.module("robot.ros_types")
        ros = Ros(self.world, types, link, quality(reliability="best_effort", depth=1))
        outcome = self._workspace.module("jausml_runtime.bridge.ends.ros_side").Outcome
        Follower(ros, self._conditions, outcome)
        Wheels(ros, self.record)
