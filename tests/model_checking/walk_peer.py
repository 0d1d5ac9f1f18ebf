"""Walks at random through the product of a bridge and its peer, and through both of them.

The runtime renews control at moments of its own, and the abstract one with each step of time; so
they may differ for as long as a renewal takes, and must agree again by then. Prints the first
difference that stays, or a command that stands for longer than the product says, as JSON.
"""

import argparse
import json
import logging
import sys
from collections import Counter
from pathlib import Path
from random import Random

from jausml_runtime import JausAddress, JausComponent, ServiceIdentity, TopicsToMessage
from jausml_runtime.messages import ClearEmergency, ReleaseControl, RequestControl, SetEmergency
from jausml_runtime.virtual import VirtualWorld
from rover.rover import Rover
from station.ros_types import Twist
from station.station import Station

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.model_checking.bridge_products import PUBLISHER, RADIO
from jausml.model_checking.systems import subjects_of

SERVICES = tuple(
    ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1)
    for name in ("Transport", "Events", "AccessControl", "Management")
)
RENEWAL_S = 1.5
"""Seconds in which both stand still again: a renewal, and a stop that is sent once more."""

SEARCH_S = 7.0
"""Seconds in which both agree again: a component that was silent is asked each five seconds."""


class Driven(Rover):
    """Moves from a command on until the stop, or until it may not any more."""

    moves = False
    station = None

    def on_set_velocity_command(self, _message, _sender):
        self.moves = self.station.velocity.stopped is None

    def on_not_ready(self):
        self.moves = False

    def on_control_lost(self):
        self.moves = False


class Walk:
    """Both in a world of their own, beside their abstract state."""

    def __init__(self, subject, seed):
        self.random = Random(seed)
        self.product, self.tick = subject.product, subject.tick
        self.state = self.product.initial()
        self.world = VirtualWorld(seed=seed)
        beside, self.radio = self.world.transport(), self.world.transport()
        self.rover, self.station = Driven(beside), Station()
        self.rover.station = self.station
        self.rover.start()
        self.station.open(self.world.ros_node("station"), self.radio)
        self.rival = self._client(beside, 1)
        self.outside, self.inside = self._client(beside, 2), self._client(self.radio, 3)
        self.said = float("-inf")
        self.longest = 0.0
        for _ in range(8):
            self._pass_time()

    def _client(self, transport, number):
        address = JausAddress(200, 1, number)
        made = JausComponent(transport, address, name=f"client {number}", services=SERVICES)
        made.start()
        return made

    def _pass_time(self):
        self.state = next(after for step, after in self.product.steps(self.state) if step.is_tick)
        self.world.run_for(self.tick)
        self._look()

    def _look(self):
        if self.rover.moves:
            self.longest = max(self.longest, self.world.now() - self.said)

    def step(self):
        """Takes one step in both."""
        choices = list(self.product.steps(self.state))
        rare = {"fails": 0.002, "is deactivated": 0.05, "SetEmergency": 0.05, "RequestControl": 0.1}
        weights = [
            3.0 if step.is_tick else rare.get(step.what, 0.3 if step.actor != PUBLISHER else 0.15)
            for step, _ in choices
        ]
        step, after = self.random.choices(choices, weights)[0]
        if step.is_tick:
            self._pass_time()
        else:
            self.state = after
            self._do(step)
            self.world.run_for(0)
        return step

    def _do(self, step):
        if step.actor == PUBLISHER:
            twist = Twist()
            twist.linear.x = 1.0
            self.said = self.world.now()
            self.world.ros.publish("/in/velocity", Twist, twist.to_cdr())
        elif step.actor == RADIO:
            (self.radio.cut if step.what == "is lost" else self.radio.restore)()
        elif step.actor == self.product.bridge:
            self.station.set_active(step.what == "is activated")
        elif step.actor == self.product.peer:
            self.rover.fail("it is told to")
        elif step.actor == self.product.rival:
            code = self.product.services.authorities[self.product.rival]
            asks = step.what == "RequestControl"
            message = RequestControl(authority_code=code) if asks else ReleaseControl()
            self.rival.send(message, self.rover.address)
        else:
            made = SetEmergency if step.what == "SetEmergency" else ClearEmergency
            is_inside = step.receiver == self.product.bridge
            sender = self.inside if is_inside else self.outside
            to = self.station.settings.address if is_inside else self.rover.address
            sender.send(made(emergency_code=1), to)

    def seen(self):
        """Returns what the real ones are like."""
        who = {self.station.settings.address: "station", self.rival.address: self.product.rival}
        return {
            "status": self.rover.status.name,
            "controller": who.get(self.rover.controller, ""),
            "own": self.station.component.status.name,
            "stopped": self.station.velocity.stopped is not None,
            "moves": self.rover.moves,
        }

    def expected(self):
        """Returns what the abstract ones are like."""
        state = self.state
        return {
            "status": state.peer.status,
            "controller": state.peer.controller,
            "own": state.own.status,
            "stopped": state.connection_state.is_stopped,
            "moves": state.is_moving,
        }

    def agrees(self):
        """Tells whether both are alike, now or as soon as they have found each other again."""
        moved = 0.0
        for _ in range(round(SEARCH_S / self.tick)):
            real, abstract = self.seen(), self.expected()
            if real == abstract:
                return True
            moved = moved + self.tick if real["moves"] and not abstract["moves"] else 0.0
            if moved > RENEWAL_S:
                return False
            self._pass_time()
        return self.seen() == self.expected()


def main():
    """Reads the command line and prints what was seen."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--walks", type=int, default=12)
    parser.add_argument("--once", action="store_true", help="send each stop once, as was done")
    parser.add_argument("--steps", type=int, default=250)
    asked = parser.parse_args()
    logging.disable()
    if asked.once:
        TopicsToMessage._stop_sent = lambda *_: None
    model = read_models([Path(__file__).with_name("rover.ros2jaus")], notations=NOTATIONS).model
    subjects = subjects_of(system_of(model))
    (subject,) = [
        candidate for candidate in subjects if candidate.name == "station.velocity to rover"
    ]
    seen, difference, longest = Counter(), None, 0.0
    for seed in range(asked.walks):
        walk, way = Walk(subject, seed), []
        for _ in range(asked.steps):
            step = walk.step()
            way.append(f"{walk.world.now():g} s {step.actor}: {step.what} {step.receiver}")
            if not walk.agrees():
                difference = {"way": way[-25:], "real": walk.seen(), "abstract": walk.expected()}
                break
            seen[repr(sorted(walk.expected().items()))] += 1
        longest = max(longest, walk.longest)
        walk.station.close()
        walk.world.close()
        if difference:
            break
    bound = subject.product.bound * subject.tick
    told = {"difference": difference, "states": len(seen), "steps": seen.total()}
    sys.stdout.write(json.dumps({**told, "longest": longest, "bound": bound}))


main()
