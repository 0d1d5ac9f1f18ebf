"""Walks at random through an abstract product and through the bridge that it stands for.

Prints the first step after which they differ, as JSON, and how many steps and states were seen.
"""

import argparse
import importlib
import json
import logging
import sys
from collections import Counter
from pathlib import Path
from random import Random

from jausml_runtime import JausAddress, JausComponent, ServiceIdentity
from jausml_runtime.messages import (
    ClearEmergency,
    ReleaseControl,
    RequestControl,
    Reset,
    Resume,
    SetEmergency,
    Shutdown,
    Standby,
)
from jausml_runtime.virtual import VirtualWorld

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.model_checking.runtime_machines import EMERGENCY_CLIENT
from jausml.model_checking.systems import subjects_of

SERVICES = tuple(
    ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1)
    for name in ("Transport", "Events", "AccessControl", "Management")
)
SIMPLE = {"Resume": Resume, "Standby": Standby, "ReleaseControl": ReleaseControl, "Reset": Reset}
SIMPLE |= {"Shutdown": Shutdown, "SetEmergency": SetEmergency, "ClearEmergency": ClearEmergency}
COMMANDS = {
    "SetVelocityCommand": lambda package, value: package.SetVelocityCommand(
        command_type=0, velocity_x=value
    ),
    "SetWrenchEffort": lambda package, value: package.SetWrenchEffort(
        propulsive_linear_effort_x=50 * value  # percent of 2 m/s
    ),
    "SetTravelSpeed": lambda package, value: package.SetTravelSpeed(speed=value),
    "SetLocalWaypoint": lambda package, value: package.SetLocalWaypoint(x=value, y=0.0),
}
READ = {
    "Twist": lambda data: data.linear.x,
    "Float64": lambda data: data.data,
    "PoseStamped": lambda data: data.pose.position.x,
}
MOST_AT_ONCE = 8
"""Steps without time between them: of more than ten refusals a second some are put off."""


class Walk:
    """One bridge in a world of its own, beside its abstract state."""

    def __init__(self, subject, seed):
        self.random = Random(seed)
        self.product, self.tick = subject.product, subject.tick
        self.state = self.product.initial()
        self.world = VirtualWorld(seed=seed)
        bridge_name, connection = subject.name.split(".")
        self.package = importlib.import_module(f"{bridge_name}.messages")
        module = importlib.import_module(f"{bridge_name}.{bridge_name}")
        self.bridge = getattr(module, bridge_name.capitalize())()
        self.bridge.open(self.world.ros_node(bridge_name), self.world.transport())
        self.connection = getattr(self.bridge, connection)
        self.address = self.bridge.settings.address
        names = [*self.product.clients, EMERGENCY_CLIENT]
        self.clients = {name: self._client(number, name) for number, name in enumerate(names)}
        self.said = 0.0
        self.listen()
        self.world.run_for(self.tick)
        self.at_once = 0

    def listen(self):
        """Hears what the bridge says to ROS."""
        ros_type, (topic,) = (
            self.connection._type,
            (ros_topic.name for ros_topic in self.connection._topics),
        )
        read = READ[ros_type.__name__]
        self.world.ros.subscribe(
            f"/{topic}", ros_type, lambda data: self._hear(read(ros_type.from_cdr(data)))
        )

    def _client(self, number, name):
        made = JausComponent(
            self.world.transport(), JausAddress(200, 1, number + 1), name=name, services=SERVICES
        )
        made.start()
        return made

    def _hear(self, value):
        self.said = value

    def step(self):
        """Takes one step in both."""
        choices = list(self.product.steps(self.state))
        if self.at_once >= MOST_AT_ONCE:
            choices = [choice for choice in choices if choice[0].is_tick]
        # Whatever ends a component is rare, so that walks are long.
        rare = {"fails": 0.03, "Shutdown": 0.03, "is deactivated": 0.3, "SetEmergency": 0.4}
        rare |= {"passes": 2.0, "Reset": 0.3, "ReleaseControl": 0.3}
        weights = [rare.get(step.what, 1.0) for step, _ in choices]
        step, self.state = self.random.choices(choices, weights)[0]
        self.at_once = 0 if step.is_tick else self.at_once + 1
        self._do(step)
        return step

    def _do(self, step):
        bridge = self.bridge
        if step.is_tick:
            self.world.run_for(self.tick)
            return
        if step.what == "fails":
            bridge.component.fail("it is told to")
        elif step.what in ("is deactivated", "is activated"):
            bridge.set_active(step.what == "is activated")
        else:
            self.send(step)
        self.world.run_for(0)

    def send(self, step):
        """Sends what a client says."""
        self.clients[step.actor].send(self._message(step), self.address)

    def _message(self, step):
        if step.what == "RequestControl":
            code = self.product.services.authorities[step.actor]
            return RequestControl(authority_code=code)
        if step.what in SIMPLE:
            made = SIMPLE[step.what]
            return made(emergency_code=1) if "Emergency" in step.what else made()
        return COMMANDS[step.what](self.package, self._value(step.actor))

    def _value(self, client):
        """Returns a value by which it is seen on the topic whose command it was."""
        return float(self.product.clients.index(client) + 1)

    def seen(self):
        """Returns what the real one is like."""
        component = self.bridge.component
        who = {client.address: name for name, client in self.clients.items()}
        emergencies = component._jaus_management._emergencies
        return {
            "status": component.status.name,
            "controller": who.get(component.controller, ""),
            "emergencies": sorted(who[emergency] for emergency in emergencies),
            "stopped": self.connection.stopped is not None,
            "halted": self.connection._halt is not None,
            "stands": self._who_stands(),
        }

    def _who_stands(self):
        nearest = [n for n in self.product.clients if abs(self.said - self._value(n)) < 0.3]
        return nearest[0] if nearest else ""

    def expected(self):
        """Returns what the abstract one is like."""
        core, connection_state = self.state.core, self.state.connection_state
        return {
            "status": core.status,
            "controller": core.controller,
            "emergencies": sorted(core.emergencies),
            "stopped": connection_state.is_stopped,
            "halted": connection_state.is_halted,
            "stands": self.state.stands,
        }


def walked(kind, subject, seed, steps):
    """Returns the first difference of a walk, if any, and what was seen on it."""
    walk, way, seen = kind(subject, seed), [], Counter()
    for _ in range(steps):
        step = walk.step()
        way.append(f"{walk.world.now():g} s {step.actor}: {step.what}")
        real, abstract = walk.seen(), walk.expected()
        seen[repr(sorted(abstract.items()))] += 1
        if real != abstract:
            return {"way": way[-25:], "real": real, "abstract": abstract}, seen
        if real["status"] == "SHUTDOWN":
            break
    walk.bridge.close()
    walk.world.close()
    return None, seen


def main(kind=Walk, model="rover.ros2jaus"):
    """Reads the command line and prints what was seen."""
    parser = argparse.ArgumentParser()
    parser.add_argument("subject")
    parser.add_argument("--walks", type=int, default=12)
    parser.add_argument("--steps", type=int, default=150)
    asked = parser.parse_args()
    logging.disable()
    model = read_models([Path(__file__).with_name(model)], notations=NOTATIONS).model
    (subject,) = [
        candidate for candidate in subjects_of(system_of(model)) if candidate.name == asked.subject
    ]
    states = Counter()
    difference = None
    for seed in range(asked.walks):
        difference, seen = walked(kind, subject, seed, asked.steps)
        states += seen
        if difference:
            break
    told = {"difference": difference, "states": len(states), "steps": states.total()}
    sys.stdout.write(json.dumps(told))


if __name__ == "__main__":
    main()
