"""The processes of the tests of lists and actions, an operator, and what they are told.

The robot is told by the test when it has reached a waypoint, so everything happens in an order.
"""

from importlib import import_module
from pathlib import Path

from ports import free_port

from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.component.component import JausComponent
from jausml.runtime.services.list_manager import chain

from ..bridge_support import Process, wait_for

LIVE = Path(__file__).resolve().parents[1]
ROBOT, STATION = JausAddress(10, 1, 1), JausAddress(10, 1, 2)
OPERATOR = JausAddress(10, 1, 9)
PATIENCE = 60.0


class Operator(JausComponent):
    """Controls the robot and gives it lists."""

    def __init__(self, transport, address=OPERATOR, authority=200, bridge="robot"):
        super().__init__(transport, address, name="operator", services=())
        self.messages = messages = import_module(f"{bridge}.messages")
        self.session = self.control(ROBOT, authority=authority)
        self.seen: list[int] = []  # what the active element was, in order
        self.ends: list[bool] = []
        self.refusals: list[int | None] = []
        self.subscribe(
            ROBOT, messages.QueryActiveElement(), messages.ReportActiveElement, self._active
        )
        self.start()

    def _active(self, report, _sender):
        if self.seen[-1:] != [report.element_uid]:  # an event that is renewed says it again
            self.seen.append(report.element_uid)

    def ready(self):
        wait_for(lambda: self.session.state is ControlState.READY, "control", PATIENCE)
        wait_for(lambda: self.seen == [0], "event of the active element", PATIENCE)

    def waypoint(self, x):
        return self.messages.SetLocalWaypoint(x=float(x), y=0.0).encode()

    def set(self, elements):
        """Sets a list and waits for the answer; True when it was confirmed."""
        answers = []
        with self.loop.lock:
            self.set_list(
                ROBOT,
                elements,
                on_done=lambda: answers.append(True),
                on_refused=lambda code: (self.refusals.append(code), answers.append(False)),
            )
        wait_for(lambda: answers, "answer to the list", PATIENCE)
        return answers[0]

    def append(self, element):
        """Sends one SetElement, which changes the list that is there."""
        record = core.SetElement.ElementRec(
            element.uid,
            element.previous_uid,
            element.next_uid,
            core.SetElement.ElementData(element.data_format, element.data),
        )
        self.send(core.SetElement(element_list=[record]), ROBOT, acknowledge=True)

    def give(self, *xs, first=1):
        """Sets a list of waypoints with these x."""
        contents = [(uid, self.waypoint(x), 0) for uid, x in enumerate(xs, first)]
        assert self.set(chain(contents))

    def execute(self, uid: int | None = 0, speed: float = 1.0):
        """Sends ExecuteList as a command whose end is told."""
        message = self.messages.ExecuteList(speed=speed, element_uid=uid)
        with self.loop.lock:
            self.command(ROBOT, message, on_done=self.ends.append, max_duration=3600)

    def _asked(self, query, report_class):
        """Asks once; the report, or None when it stayed unanswered."""
        answers = []
        with self.loop.lock:
            self.query(
                ROBOT,
                query,
                report_class,
                lambda report, _sender: answers.append(report),
                on_failure=lambda: answers.append(None),
            )
        wait_for(lambda: answers, f"end of {type(query).__name__}", PATIENCE)
        return answers[0]

    def asked_speed(self):
        """The speed that the robot tells."""
        messages = self.messages
        return round(self._asked(messages.QueryTravelSpeed(), messages.ReportTravelSpeed).speed, 1)

    def asked_x(self):
        """The x of the waypoint that the robot tells; None for no answer."""
        messages = self.messages
        query = messages.QueryLocalWaypoint(presence_vector=0)
        report = self._asked(query, messages.ReportLocalWaypoint)
        return None if report is None else round(report.x, 1)

    def rest(self):
        """Leaves the robot's bridge as one that has just begun."""
        self.clear_emergency(ROBOT)
        wait_for(lambda: self.session.state is ControlState.READY, "control", PATIENCE)
        answers = []
        self.delete_elements(
            ROBOT,
            [65535],
            on_done=lambda: answers.append(True),
            on_refused=lambda _: answers.append(False),  # there is none
        )
        wait_for(lambda: answers, "answer to the deletion", PATIENCE)
        self.wait_active(0)

    def wait_active(self, uid):
        wait_for(lambda: self.seen[-1] == uid, f"active element {uid}", PATIENCE)


class System:
    """Processes of one test, or of several one after the other.

    Attributes:
        lasts: Whether what runs now serves the next test too.
    """

    def __init__(self, folder, packages):
        self.folder = folder
        self.packages = packages
        self.port = free_port()
        self.processes: dict[str, Process] = {}
        self.lasts = False
        self._before: dict[Process, tuple[int, int]] = {}

    def begin(self):
        """Begins another test, which does not look at what was said before it."""
        if not self.lasts:
            self.close()
        self.lasts = True
        self._before = {
            process: (len(process.facts), process.log.stat().st_size)
            for process in self.processes.values()
        }

    def _start(self, name, arguments, **more):
        process = Process(arguments, self.packages, self.folder / f"{name}.log", **more)
        self.processes[name] = process
        return process

    def start_bridge(self, name, *arguments):
        line = ["--jaus-port", str(self.port), *arguments]
        return self._start(name, ["-m", f"{name}.main", *line])

    def start_ros_robot(self, *arguments):
        robot = self._start("ros", [str(LIVE / "list_robot.py"), *arguments], stdin=True)
        wait_for(lambda: robot.of_kind("ready"), "the robot", PATIENCE)
        return robot

    def log_of(self, name):
        process = self.processes[name]
        _, written = self._before.get(process, (0, 0))
        return process.log.read_bytes()[written:].decode(errors="replace")

    def facts(self, *kinds):
        process = self.processes["ros"]
        said, _ = self._before.get(process, (0, 0))
        return [fact for fact in process.facts[said:] if fact["kind"] in kinds]

    def open_goals(self):
        """How many goals of this test its robot still follows."""
        return len(self.facts("goal")) - len(self.facts("canceled", "aborted", "done"))

    def close(self):
        for process in self.processes.values():
            process.close()
        self.processes.clear()


def facts(system, *kinds):
    return system.facts(*kinds)


def order(system, *words):
    for word in words:
        system.processes["ros"].tell(word)


def pass_by(system, operator, *uids):
    """Has the robot go from one element to the next ones, and after the last to the end.

    Feedback and result of a ROS action are not in order with each other: each is waited for.
    """
    for uid in (*uids, 0):
        order(system, "next")
        operator.wait_active(uid)


def wait_goal(system, number=1):
    wait_for(lambda: len(facts(system, "goal")) >= number, f"goal {number}", PATIENCE)
    return facts(system, "goal")[number - 1]
