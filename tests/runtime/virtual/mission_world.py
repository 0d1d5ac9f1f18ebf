"""A robot with missions of an operator or of a station, in virtual time.

Plays scenes, each of a line with its name and its share of losses, and prints what happened.
"""

import json
import logging
import sys

from jausml_runtime import JausAddress, JausComponent, ListManagerService, ServiceIdentity
from jausml_runtime.bridge.ends.actions import Outcome
from jausml_runtime.virtual import Link, VirtualWorld
from pausing.pausing import Pausing
from robot.messages import (
    AbortMission,
    PauseMission,
    QueryMissionStatus,
    ReportMissionStatus,
    ResumeMission,
    RunMission,
    SetLocalWaypoint,
    SpoolMission,
)
from robot.robot import Robot
from robot.ros_types import PoseStamped
from station.station import Station

ROBOT, OPERATOR = JausAddress(100, 1, 20), JausAddress(200, 1, 1)
SERVICES = tuple(
    ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1)
    for name in ("Transport", "Events", "AccessControl", "Management")
)


def waypoint(uid, x, to=ROBOT, message=None):
    """Returns a message of a task."""
    destination = SpoolMission.DestinationID(to.component, to.node, to.subsystem)
    data = SetLocalWaypoint(x=x, y=0.0).encode() if message is None else message
    return SpoolMission.MessageData(uid, destination, data, 1)


def task(number, *messages, children=()):
    """Returns a task of a mission."""
    data = SpoolMission.TaskData(SpoolMission.TaskInfo(number), list(messages))
    return SpoolMission.Task(data, [SpoolMission.SubTaskIndex(child) for child in children])


PLAN = (
    task(8, waypoint(1, 3.0)),
    task(7, waypoint(1, 1.0), waypoint(2, 2.0), children=(0, 2)),
    task(9, waypoint(1, 4.0)),
)
"""The task 7 first, then its subtasks 8 and 9."""


class Driving:
    """The world, and what the robot drives to."""

    def __init__(self, loss):
        self.world = VirtualWorld(seed=3)
        self.driven, self.told, self.goal = [], [], None
        self.world.ros.serve_action("/follow", self)
        self.robot = Robot()
        self.link = Link(loss=loss, delay=0.05)
        self.way = self.world.transport(self.link, self.link)
        self.robot.open(self.world.ros_node("robot"), self.way)

    def accepts(self, _elements, _request):
        return True

    def begin(self, goal):
        self.goal = goal
        self.driven.append(
            [round(PoseStamped.from_cdr(element).pose.position.x, 3) for element in goal.elements]
        )

    def cancel(self, goal):
        if goal is self.goal:
            self.goal = None
            goal.end(Outcome.CANCELED)

    def reach(self, number):
        self.goal.progress(number)
        self.world.run_for(1)

    def end(self, outcome=Outcome.SUCCEEDED):
        goal, self.goal = self.goal, None
        goal.end(outcome)
        self.world.run_for(1)


class Scene(Driving):
    """An operator with missions, and what it is told."""

    def __init__(self, loss):
        super().__init__(loss)
        self.operator = JausComponent(
            self.world.transport(), OPERATOR, name="operator", services=SERVICES
        )
        self.operator.handle(ReportMissionStatus, self._hear)
        self.operator.start()
        self.session = self.operator.control(ROBOT, authority=200)
        self.world.run_for(5)

    def _hear(self, report, _sender):
        self.told.append((report.type_, report.id_, report.status, report.secondary_status))

    def say(self, message):
        self.operator.send(message, ROBOT, acknowledge=True)
        self.world.run_for(2)

    def ask(self, **query):
        before = len(self.told)
        self.say(QueryMissionStatus(**query))
        return self.told.pop()[2] if len(self.told) > before else None

    def spool(self, *tasks, number=5):
        source = SpoolMission.SourceID(1, 1, 200)
        info = SpoolMission.MissionInfo(number, source)
        self.say(SpoolMission(info, list(tasks or PLAN)))


class Client:
    """A goal of a ROS client, and what it is told."""

    def __init__(self, scene, xs):
        poses = [PoseStamped() for _ in xs]
        for pose, x in zip(poses, xs, strict=True):
            pose.pose.position.x = x
        self.feedback, self.result = [], None
        way = scene.world.ros.action_client("/through")
        self.handle = way.send([target_pose.to_cdr() for target_pose in poses], None, self)

    def accepted(self, _goal):
        """Notes nothing."""

    def progressed(self, _goal, number):
        self.feedback.append(number)

    def ended(self, _goal, outcome, reason):
        self.result = [outcome.value, reason]


class Sending(Driving):
    """A station, whose ROS clients have missions for the robot."""

    def __init__(self, loss, kind=Station):
        super().__init__(loss)
        self.station, self.radio = kind(), self.world.transport()
        self.station.open(self.world.ros_node("station"), self.radio)
        self.world.run_for(10)

    def wait(self, condition):
        """Lets time pass until a condition holds, but not for longer than a minute."""
        for _ in range(600):
            if condition():
                return
            self.world.run_for(0.1)

    def send(self, *xs):
        """Sends a goal until the robot drives."""
        former = len(self.driven)
        client = Client(self, xs)
        self.wait(lambda: client.result or len(self.driven) > former)
        return client

    @property
    def state(self):
        """The state of the mission that the robot has."""
        (driver,) = self.robot.component.part(ListManagerService).drivers
        return driver._mission and int(driver._mission.state)


def whole(scene):
    scene.spool()
    scene.say(RunMission())
    asked = [scene.ask(task_id=7), scene.ask(task_id=8), scene.ask(task_id=7, uid=1)]
    scene.reach(2)
    asked += [scene.ask(task_id=7), scene.ask(task_id=8), scene.ask(mission_id=5)]
    scene.end()
    asked += [scene.ask(), scene.ask(mission_id=6)]
    return asked


def paused(scene):
    scene.spool()
    scene.say(RunMission())
    scene.reach(1)
    scene.say(PauseMission())
    asked = [scene.goal is None, scene.ask()]
    scene.say(ResumeMission(5))
    scene.reach(1)
    scene.end()
    return [*asked, scene.ask()]


def paused_behind_a_task(scene):
    scene.spool()
    scene.say(RunMission())
    scene.say(PauseMission(mission_id=5, task_id=7))
    asked = [scene.ask()]
    scene.reach(2)
    return [*asked, scene.ask(), scene.goal is None]


def begun_at_a_message(scene):
    scene.spool()
    scene.say(RunMission(mission_id=5, task_id=7, message_uid=2))
    asked = [scene.ask(task_id=7, uid=1), scene.ask(task_id=7, uid=2)]
    scene.say(PauseMission())
    scene.say(RunMission(mission_id=5, task_id=99))  # there is no such task
    return [*asked, scene.ask(task_id=7, uid=1)]


def aborted(scene):
    scene.spool()
    scene.say(RunMission())
    scene.spool(task(1, waypoint(1, 9.0)), number=6)
    scene.say(AbortMission(5))
    asked = [scene.goal is None, scene.ask()]
    scene.say(RunMission())
    return asked


def failed(scene):
    scene.spool()
    scene.say(RunMission())
    scene.end(Outcome.ABORTED)
    return [scene.ask()]


def operator_lost(scene):
    scene.spool()
    scene.say(RunMission())
    scene.reach(1)
    scene.way.cut()
    scene.world.run_for(20)
    asked = [scene.goal is None]
    scene.way.restore()
    scene.world.run_for(20)
    asked += [scene.ask(), scene.goal is None]
    scene.say(ResumeMission(5))
    return [*asked, scene.ask()]


def refused(scene):
    scene.spool(task(1, waypoint(1, 1.0), children=(0,)))
    scene.spool(task(1, waypoint(1, 1.0), children=(1,)))
    scene.spool(task(1, waypoint(1, 1.0, to=JausAddress(100, 1, 21))))
    scene.spool(task(1, waypoint(1, 1.0, message=b"\x01\x00")))
    scene.say(RunMission())
    return [scene.ask()]


def sent_whole(scene):
    client = scene.send(1.0, 2.0, 3.0)
    for number in (1, 2):
        scene.reach(number)
        scene.wait(lambda at=number: client.feedback[-1:] == [3 - at])
    scene.end()
    scene.wait(lambda: client.result)
    again = scene.send(4.0)
    scene.end()
    scene.wait(lambda: again.result)
    return [client.feedback, client.result, scene.state, again.result]


def sent_cancelled(scene):
    client = scene.send(1.0, 2.0)
    scene.world.run_for(3)
    client.handle.cancel()
    scene.wait(lambda: client.result)
    scene.world.run_for(10)
    told = [client.result, scene.goal is None, scene.state]
    following = scene.send(3.0)
    return [*told, scene.state, following.result]


def sent_cancelled_early(scene):
    """The goal ends while the mission is on its way, or RunMission is."""
    ends = []
    for hundredths in range(0, 160, 10):
        before, client = len(scene.driven), Client(scene, [1.0, 2.0])
        scene.world.run_for(hundredths / 100)
        client.handle.cancel()
        scene.wait(lambda told=client: told.result)
        scene.world.run_for(10)
        begun = len(scene.driven) > before
        ends.append([client.result[0], begun, scene.goal is None, scene.state])
    return ends


def sent_ended_before_it_is_stored(scene):
    """The client cancels, then another goal comes, while a mission is on its way."""
    asked = []
    code = QueryMissionStatus.CODE.to_bytes(2, "little")
    # The payload of a packet comes after the version and the header (AS5669A).
    scene.world.watch(lambda _now, _where, data: asked.append(data[13:15] == code))
    client = Client(scene, [1.0, 2.0])
    scene.world.run_for(0.02)
    client.handle.cancel()
    scene.wait(lambda: client.result)
    scene.world.run_for(5)
    told = [any(asked)]
    Client(scene, [3.0])
    scene.world.run_for(0.02)
    client = scene.send(4.0)
    told.append(any(asked))
    scene.end()
    scene.wait(lambda: client.result)
    asked.clear()
    scene.world.run_for(5)
    return [*told, any(asked)]


def sent_cancelled_far_away(scene):
    """The radio is away when the client cancels, and is back before control is lost."""
    client = scene.send(1.0, 2.0)
    scene.world.run_for(3)
    scene.radio.cut()
    client.handle.cancel()
    scene.world.run_for(3)
    told = [client.result, scene.goal is None]
    scene.radio.restore()
    scene.world.run_for(10)
    return [*told, scene.goal is None, scene.state]


def sent_replaced(scene):
    first, second = scene.send(1.0, 2.0), scene.send(5.0)
    scene.end()
    scene.wait(lambda: second.result)
    return [first.result, second.result, scene.state]


def sent_failed(scene):
    client = scene.send(1.0, 2.0)
    scene.world.run_for(3)
    scene.end(Outcome.ABORTED)
    scene.wait(lambda: client.result)
    return [client.result, scene.state]


def sent_robot_gone(scene):
    client = scene.send(1.0, 2.0)
    scene.world.run_for(3)
    scene.way.cut()
    scene.world.run_for(20)
    told = [client.result, scene.goal is None, scene.state]
    scene.way.restore()
    scene.world.run_for(20)
    return [*told, scene.goal is None, scene.state]


def sent_station_ends(scene):
    scene.send(1.0, 2.0)
    scene.world.run_for(3)
    scene.station.close()
    scene.world.run_for(1)
    return [scene.goal is None, scene.state]


def sent_refused(scene):
    """The robot has a mission of its operator already."""
    (driver,) = scene.robot.component.part(ListManagerService).drivers
    mission = SpoolMission.MissionInfo(7, SpoolMission.SourceID(1, 1, 200))
    driver._spool(SpoolMission(mission, list(PLAN)), OPERATOR)
    client = scene.send(1.0)
    return [client.result, scene.state, driver._mission.number]


def play(word, loss):
    """Plays a scene, after `pausing_` with the station that pauses."""
    name = word.removeprefix("pausing_")
    if not name.startswith("sent_"):
        scene = Scene(loss)
    else:
        scene = Sending(loss, Station if name == word else Pausing)
    asked = globals()[name](scene)
    counted = {
        name: count
        for name, count in scene.world.counters.snapshot().items()
        if name.startswith(("mission.", "loop."))
    }
    return {"driven": scene.driven, "told": scene.told, "asked": asked, "counted": counted}


logging.disable()
for line in sys.stdin:
    word, loss = line.split()
    sys.stdout.write(f"{json.dumps(play(word, float(loss)))}\n")
    sys.stdout.flush()
