"""Walks at random through the winch as a product, and through the winch that is generated.

Conditions of the user say the same in both. Prints the first difference, as JSON.
"""

import argparse
import json
import logging
import sys
from collections import Counter
from pathlib import Path
from random import Random
from types import MappingProxyType

from jausml_runtime import JausAddress, JausComponent, ServiceIdentity
from jausml_runtime import messages as core
from jausml_runtime.virtual import VirtualWorld
from winch import messages
from winch.winch_base import WinchBase

from jausml.generation.target import system_of
from jausml.language.model import read_models
from jausml.model_checking.runtime_machines import CLIENT_MESSAGES, EMERGENCY_CLIENT
from jausml.model_checking.systems import subjects_of
from jausml_generators.python.names import snake_case

MODEL = Path(__file__).resolve().parents[2] / "models" / "examples" / "winch" / "winch.xmi"
SERVICES = tuple(
    ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1)
    for name in ("Transport", "Events", "AccessControl", "Management")
)
RARE = ("SetEmergency", "Shutdown", "fails", "Reset", "ReleaseControl", "Standby")


class Winch(WinchBase):
    """A winch whose conditions are told what to say."""

    said = MappingProxyType({})

    def leads_beyond_rope(self, *_):
        return self.said.get("leads_beyond_rope", True)

    def pays_out(self, *_):
        return self.said.get("pays_out", True)

    def pays_in(self, *_):
        return self.said.get("pays_in", True)


class Walk:
    """A winch in a world of its own, beside its abstract state."""

    def __init__(self, subject, seed):
        self.random = Random(seed)
        self.product, self.tick = subject.product, subject.tick
        self.state = self.product.initial()
        self.world = VirtualWorld(seed=seed)
        self.winch = Winch(self.world.transport())
        self.winch.start()
        self.clients = {}
        for number, name in enumerate((*self.product.clients, EMERGENCY_CLIENT), 1):
            address = JausAddress(200, 1, number)
            transport = self.world.transport()
            self.clients[name] = JausComponent(transport, address, name=name, services=SERVICES)
            self.clients[name].start()
        self.world.run_for(self.tick)
        self.at_once = 0

    def step(self):
        """Takes one step in both; returns what it was."""
        self.at_once += 1
        if self.at_once > 8:
            return self._of_the_core(ticks=True)
        if self.random.random() < 0.5:
            return self._of_the_core(ticks=False)
        return self._of_the_machine()

    def _of_the_core(self, *, ticks):
        known = {*CLIENT_MESSAGES, "SetEmergency", "ClearEmergency", "fails", "passes"}
        steps = [
            candidate for candidate in self.product.steps(self.state) if candidate[0].what in known
        ]
        steps = [
            candidate_step for candidate_step in steps if candidate_step[0].is_tick or not ticks
        ]
        weights = [0.05 if step.what in RARE else 1.0 for step, _ in steps]
        step, self.state = self.random.choices(steps, weights)[0]
        if step.is_tick:
            self.at_once = 0
            self.world.run_for(self.tick)
        elif step.what == "fails":
            self.winch.fail("it is told to")
        else:
            self._send(step.actor, self._core_message(step))
        return f"{step.actor}: {step.what}"

    def _core_message(self, step):
        if step.what == "RequestControl":
            authorities = self.product.services.authorities
            return core.RequestControl(authority_code=authorities[step.actor])
        made = getattr(core, step.what)
        return made(emergency_code=1) if "Emergency" in step.what else made()

    def _of_the_machine(self):
        trigger = self.random.choice([*self.product.messages(), *self.product.events()])
        is_event = trigger in self.product.events()
        sender = "" if is_event else self.random.choice(self.product.clients)
        outcomes = list(self.product.outcomes(self.state, trigger, sender))
        said, transition = self.random.choice(outcomes or [({}, None)])
        self.winch.said = {snake_case(name): value for name, value in said.items()}
        if transition is not None:
            _, self.state = self.product.step(self.state, transition, trigger, sender)
        if is_event:
            getattr(self.winch, f"raise_{snake_case(trigger)}")()
        else:
            self._send(sender, getattr(messages, trigger)())
        return f"{sender}: {trigger} {said}"

    def _send(self, sender, message):
        self.clients[sender].send(message, self.winch.address)
        self.world.run_for(0)

    def seen(self):
        """Returns where the real one is."""
        (machine,) = self.winch._jaus_machines
        who = {client.address: name for name, client in self.clients.items()}
        return [self.winch.status.name, who.get(self.winch.controller, ""), machine.state]

    def expected(self):
        """Returns where the abstract one is."""
        return [self.state.core.status, self.state.core.controller, self.state.path]


def main():
    """Reads the command line and prints what was seen."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--walks", type=int, default=12)
    parser.add_argument("--steps", type=int, default=250)
    asked = parser.parse_args()
    logging.disable()
    (subject,) = subjects_of(system_of(read_models([MODEL]).model))
    seen, difference = Counter(), None
    for seed in range(asked.walks):
        walk, way = Walk(subject, seed), []
        for _ in range(asked.steps):
            way.append(walk.step())
            if walk.seen() != walk.expected():
                difference = {"way": way[-15:], "real": walk.seen(), "abstract": walk.expected()}
                break
            seen[repr(walk.expected())] += 1
            if walk.state.core.status == "SHUTDOWN":
                break
        walk.world.close()
        if difference:
            break
    told = {"difference": difference, "states": len(seen), "steps": seen.total()}
    sys.stdout.write(json.dumps(told))


main()
