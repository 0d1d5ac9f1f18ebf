"""A bridge with ROS services, a lamp, an operator, and a node of the test."""

from functools import partial
from pathlib import Path

from ports import free_port

from .bridge_support import Process, RosPeer, wait_for

FOLDER = Path(__file__).resolve().parent
MODEL = FOLDER / "services.ros2jaus"


class System:
    """The bridge, a lamp, an operator, and a node of the test."""

    def __init__(self, path, logs, *arguments):
        from rclpy.qos import QoSProfile
        from std_srvs.srv import SetBool, Trigger

        self.path, self.logs, self.port = path, logs, free_port()
        self.processes = []
        self.ros = RosPeer()
        self.bridge = self.start("-m", "front.main", *arguments)
        create = partial(self.ros.node.create_client, qos_profile=QoSProfile(depth=100))
        self.clients = {
            "read": create(Trigger, "/read_lamp"),
            "switch": create(SetBool, "/switch_lamp"),
            "shine": create(Trigger, "/shine"),
        }

    def start(self, *arguments):
        line = [*arguments, "--jaus-port", str(self.port)]
        log = self.logs / f"{len(self.processes)}.log"
        process = Process(line, self.path, log, stdin=True)
        self.processes.append(process)
        return process

    def lamp(self, mode="answer"):
        process = self.start(str(FOLDER / "lamp.py"))
        process.tell(mode)
        wait_for(lambda: process.of_kind("mode"), "lamp")
        return process

    def mode(self, lamp, mode):
        lamp.tell(mode)
        wait_for(lambda: lamp.of_kind("mode")[-1]["mode"] == mode, mode)

    def send(self, name, **members):
        """Sends a request; returns the future of its response."""
        client = self.clients[name]
        wait_for(client.service_is_ready, f"service {name}")
        return client.call_async(client.srv_type.Request(**members))

    def call(self, name, **members):
        future = self.send(name, **members)
        wait_for(future.done, f"response of {name}")
        return future.result()

    def switched(self, **members):
        """Switches the lamp until the bridge controls it."""
        answers = []

        def switch():
            answers.append(self.call("switch", **members))
            return "no peer obeys" not in answers[-1].message

        wait_for(switch, "control of the lamp")
        return answers[-1]

    def operator(self):
        """Returns an operator that controls the bridge."""
        process = self.start(str(FOLDER / "lamp_operator.py"))
        process.tell("take")
        wait_for(lambda: "READY" in states(process), "control of the bridge")
        return process

    def serve(self, handler):
        """Serves what the bridge calls."""
        from rclpy.callback_groups import ReentrantCallbackGroup
        from std_srvs.srv import SetBool

        made = self.ros.node.create_service(
            SetBool, "/lamp/switch", handler, callback_group=ReentrantCallbackGroup()
        )
        self.ros.executor.wake()
        wait_for(lambda: self.value("switch_robot", "service is") == "there", "discovery")
        return made

    def status(self, connection):
        """Returns the latest diagnostics of a connection."""
        from diagnostic_msgs.msg import DiagnosticArray

        found = self.ros.listen(DiagnosticArray, "/diagnostics")
        for array in reversed(list(found)):
            for status in array.status:
                if status.name.endswith(connection):
                    return status
        return None

    def value(self, connection, key):
        status = self.status(connection)
        values = {value.key: value.value for value in status.values} if status is not None else {}
        return values.get(key)

    def close(self):
        for process in self.processes:
            process.close()
        self.ros.close()
        logs = "".join(
            system_process.log.read_text(encoding="utf-8") for system_process in self.processes
        )
        assert "Traceback" not in logs, logs


def states(process):
    return [fact["state"] for fact in process.of_kind("control")]
