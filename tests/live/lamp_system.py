"""A bridge with ROS services, a lamp, an operator, and a node of the test."""

from functools import partial
from pathlib import Path

from . import bridge_support
from .bridge_support import wait_for

FOLDER = Path(__file__).resolve().parent
MODEL = FOLDER / "services.ros2jaus"


class System(bridge_support.System):
    """The bridge, a lamp and an operator."""

    def __init__(self, path, logs, *arguments):
        from diagnostic_msgs.msg import DiagnosticArray
        from rclpy.qos import QoSProfile
        from std_srvs.srv import SetBool, Trigger

        super().__init__(path, logs)
        self.bridge = self.start("-m", "front.main", *arguments)
        create = partial(self.ros.node.create_client, qos_profile=QoSProfile(depth=100))
        self.clients = {
            "read": create(Trigger, "/read_lamp"),
            "switch": create(SetBool, "/switch_lamp"),
            "shine": create(Trigger, "/shine"),
        }
        # Announced behind the clients: who sends to it knows them, and loses no response.
        self.told = self.ros.listen(DiagnosticArray, "/diagnostics")

    def lamp(self, mode="answer"):
        process = self.start(str(FOLDER / "lamp.py"), stdin=True)
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
        wait_for(lambda: self.told, "discovery of the clients")
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
        process = self.start(str(FOLDER / "lamp_operator.py"), stdin=True)
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

    def value(self, connection, key):
        return self.ros.values(connection).get(key)

    def close(self):
        super().close()
        logs = [process.log.read_text(encoding="utf-8") for process in self.processes]
        assert "Traceback" not in "".join(logs)


def states(process):
    return [fact["state"] for fact in process.of_kind("control")]
