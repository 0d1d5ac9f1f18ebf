"""An operator and a robot with missions in virtual time: plays a scene, prints what happened."""

from __future__ import annotations

import json
import logging
import sys

from jausml_runtime import JausAddress, JausComponent, ServiceIdentity
from jausml_runtime.bridge.ends.actions import Outcome
from jausml_runtime.virtual import Link, VirtualWorld
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
    return SpoolMission.Task(data, [SpoolMission.SubTaskIndex(each) for each in children])


PLAN = (
    task(8, waypoint(1, 3.0)),
    task(7, waypoint(1, 1.0), waypoint(2, 2.0), children=(0, 2)),
    task(9, waypoint(1, 4.0)),
)
"""The task 7 first, then its subtasks 8 and 9."""


class Scene:
    """The world, what the robot drives to, and what the operator is told."""

    def __init__(self, loss):
        self.world = VirtualWorld(seed=3)
        self.driven, self.told, self.goal = [], [], None
        self.world.ros.serve_action("/follow", self)
        self.robot = Robot()
        link = Link(loss=loss)
        self.way = self.world.transport(link, link)
        self.robot.open(self.world.ros_node("robot"), self.way)
        self.operator = JausComponent(
            self.world.transport(), OPERATOR, name="operator", services=SERVICES
        )
        self.operator.handle(ReportMissionStatus, self._hear)
        self.operator.start()
        self.session = self.operator.control(ROBOT, authority=200)
        self.world.run_for(5)

    def _hear(self, report, _sender):
        self.told.append((report.type_, report.id_, report.status, report.secondary_status))

    def accepts(self, _elements, _request):
        return True

    def begin(self, goal):
        self.goal = goal
        self.driven.append(
            [round(PoseStamped.from_cdr(each).pose.position.x, 3) for each in goal.elements]
        )

    def cancel(self, goal):
        if goal is self.goal:
            self.goal = None
            goal.end(Outcome.CANCELED)

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

    def reach(self, number):
        self.goal.progress(number)
        self.world.run_for(1)

    def end(self, outcome=Outcome.SUCCEEDED):
        goal, self.goal = self.goal, None
        goal.end(outcome)
        self.world.run_for(1)


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
    return [scene.ask(task_id=7, uid=1), scene.ask(task_id=7, uid=2)]


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


def main():
    """Plays the scene of the command line."""
    logging.disable()
    scene = Scene(float(sys.argv[2]))
    asked = globals()[sys.argv[1]](scene)
    counted = {
        name: each
        for name, each in scene.world.counters.snapshot().items()
        if name.startswith(("mission.", "loop."))
    }
    happened = {"driven": scene.driven, "told": scene.told, "asked": asked, "counted": counted}
    sys.stdout.write(json.dumps(happened))


main()
