"""One drive in virtual time: the generated processes of a system and a plant on one clock.

J and R run the code that `systems.py` generates, with the user code of the models. The processes
talk over the virtual network of the runtime, the ROS nodes of R are stand-ins that run the same
control laws (`standins.py`). Equal conditions give equal runs, to the last bit.
"""

from __future__ import annotations

import random
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from catvehicle.plants import plant_of
from catvehicle.progress import is_at_goal
from catvehicle.realtime import RealTimePlant

from experiments.right_turn.data import Run
from experiments.right_turn.drives import judged
from experiments.right_turn.record import ControllerLog, Record, VehicleLog, hops, percentiles
from experiments.right_turn.standins import Ros, SpeedNode, SteeringNode

if TYPE_CHECKING:
    from collections.abc import Mapping

    from catvehicle.plant import BicyclePlant

    from experiments.right_turn.generated import Workspace

START = datetime(2026, 1, 1, tzinfo=timezone.utc)
"""Time of day at which each run begins."""

HOP = {"delay": 0.0002, "jitter": 0.0002}
"""Way of a packet between two processes of one computer, s; an assumption, of the size that the
runs in wall time show. It is the same for J and R, and what conditions ask for is added to it."""

ROS_HOP = 0.0003
"""Way of a ROS message between two processes of one computer, s; an assumption likewise."""

LIMIT = 60.0
"""Virtual seconds after which a drive is over in any case."""
START_SPREAD = 0.1
"""Processes start at random within so many seconds: the phases between them differ by seed."""
FAILURES = ("loop.callback_failed", "component.handler_failed")
"""Counters of code that raised what it should not."""
PATH = StraightArcStraight.right_turn(VehicleParameters())
"""The path that the controllers follow."""


@dataclass(frozen=True)
class Conditions:
    """What a drive meets.

    Attributes:
        system: `J` or `R`.
        seed: Seed of the network and of the phases between the processes.
        sense: Fields of the `Link` of reports, from the vehicle; added to those of `HOP`.
        act: Fields of the `Link` of commands, to the vehicle; likewise.
    """

    system: str = "R"
    seed: int = 1
    sense: Mapping[str, float] = field(default_factory=dict)
    act: Mapping[str, float] = field(default_factory=dict)


def _observed_vehicle(
    vehicle: Any, record: Record, parameters: VehicleParameters, plant: BicyclePlant
) -> Any:
    """Returns the class of the vehicle with a given plant, and seen by a record."""

    class ObservedVehicle(vehicle):  # type: ignore[misc] - known when it runs
        def __init__(self, transport: Any) -> None:
            super().__init__(transport)
            self._parameters = parameters
            self._plant = RealTimePlant(parameters, self.clock.now, plant)
            self._events = VehicleLog(record)
            self._has_moved = False

        def on_set_wrench_effort(self, message: Any, sender: Any) -> None:
            super().on_set_wrench_effort(message, sender)
            # The stop of the bridge is not quite zero: the field has no zero.
            if not self._has_moved and (message.propulsive_linear_effort_x or 0.0) > 0.1:
                self._has_moved = True
                record.watch(self._plant.sample)

    return ObservedVehicle


def _observed_controller(controller: Any, record: Record) -> Any:
    """Returns the class of the JAUS controller, seen by a record."""

    class ObservedController(controller):  # type: ignore[misc] - known when it runs
        def __init__(self, transport: Any) -> None:
            super().__init__(transport)
            self._log = ControllerLog(record)

    return ObservedController


class Drive:
    """A system and its plant in one virtual world.

    Attributes:
        conditions: What it meets.
        world: The world.
        record: What is seen.
        vehicle_transport: The transport of the vehicle, with the links of the conditions.
        controlling_transport: That of the JAUS controller, or of the bridge.
        nodes: The stand-ins of the ROS nodes.
    """

    def __init__(self, conditions: Conditions, workspace: Workspace) -> None:
        """Make the processes; none has started.

        Args:
            conditions: What the drive meets.
            workspace: Generated code of its system.
        """
        virtual = workspace.module("jausml_runtime.virtual")
        self.conditions = conditions
        self.world = virtual.VirtualWorld(seed=conditions.seed, start=START)
        self.record = Record(self.world)
        self.link = virtual.Link
        self.vehicle_transport = self.world.transport(
            out=self.worse(conditions.sense), into=self.worse(conditions.act)
        )
        self.controlling_transport = self.world.transport()
        self.nodes: list[SteeringNode | SpeedNode] = []
        self._ros_link = virtual.Link(delay=ROS_HOP)
        self._workspace = workspace

    def worse(self, added: Mapping[str, float]) -> Any:
        """Returns the link of a hop with what is added to it."""
        return self.link(**{**added, **{name: added.get(name, 0.0) + HOP[name] for name in HOP}})

    def start(self) -> None:
        """Start the processes, one after the other, each at a time of its own."""
        chance = random.Random(f"phases of {self.conditions.seed}")
        times = sorted(chance.uniform(0.0, START_SPREAD) for _ in range(3))
        starts = [self._start_vehicle, self._start_operator, self._start_control]
        chance.shuffle(starts)
        for when, start in zip(times, starts, strict=True):
            self.world.run_for(when - self.world.now())
            start()

    def _start_vehicle(self) -> None:
        vehicle = self._workspace.module("vehicle.vehicle").Vehicle
        parameters = VehicleParameters()
        plant = plant_of("kinematic", parameters)
        observed = _observed_vehicle(vehicle, self.record, parameters, plant)
        observed(self.vehicle_transport).start()

    def _start_operator(self) -> None:
        module = self._workspace.module("operator_control_unit.operator_control_unit")
        module.OperatorControlUnit(self.world.transport()).start()

    def _start_control(self) -> None:
        if self.conditions.system == "J":
            self._start_controller()
        else:
            self._start_bridge()
            self._start_nodes()

    def _start_controller(self) -> None:
        controller = self._workspace.module("controller.controller").Controller
        observed = _observed_controller(controller, self.record)
        observed(self.controlling_transport).start()

    def _start_bridge(self) -> None:
        ros = self.world.ros_node("bridge", {}, link=self._ros_link)
        self.bridge = self._workspace.module("bridge.bridge").Bridge()
        self.bridge.open(ros, self.controlling_transport)

    def _start_nodes(self) -> None:
        quality = self._workspace.module("jausml_runtime").Qos
        types = self._workspace.module("bridge.ros_types")
        sensing = quality(reliability="best_effort", depth=5)
        ros = Ros(self.world, types, self._ros_link, sensing)
        parameters = VehicleParameters()
        steering = SteeringNode(ros, parameters, self.record.steps.append)
        self.nodes = [steering, SpeedNode(ros, parameters)]

    def run(self, seconds: float | None = None) -> None:
        """Let the vehicle drive until it rests, or for some time at most.

        Args:
            seconds: Virtual seconds from now; without them up to `LIMIT` since the world began.
        """
        end = LIMIT if seconds is None else self.world.now() + seconds
        while not self.record.is_over and self.world.now() < end:
            self.world.run_for(min(0.25, end - self.world.now()))

    def finish(self, name: str, system: str | None = None) -> Run:
        """End the world and return what was seen.

        Args:
            name: Name of the run.
            system: Name of the system; that of the conditions by default.

        Raises:
            RuntimeError: Code of a process has failed: what was seen would mean nothing.
        """
        counted = self.world.counters.snapshot()
        failed = {failure: counted[failure] for failure in FAILURES if failure in counted}
        if failed:
            raise RuntimeError(f"{name}: code has failed in virtual time: {failed}")
        self.world.close()
        samples, conditions = self.record.samples, self.conditions
        # Before the first motion the vehicle may have refused what it was asked for.
        steps = [step for step in self.record.steps if step.sent >= self.record.begun]
        latencies = hops(steps, self.record.events)
        return Run(
            system=system or conditions.system,
            name=name,
            mode="virtual",
            seed=conditions.seed,
            arrived=self._has_arrived(),
            samples=samples,
            steps=self.record.steps,
            events=self.record.events,
            latencies=latencies,
            config=asdict(conditions),
            metrics=judged(samples) | percentiles(latencies),
            counters=counted | self._packets(),
        )

    def _has_arrived(self) -> bool:
        if not (self.record.is_over and self.record.samples):
            return False
        last = self.record.samples[-1]
        return is_at_goal(PATH, last.x, last.y)

    def _packets(self) -> dict[str, int]:
        """Returns how many packets went and got lost."""
        vehicle, control = self.vehicle_transport, self.controlling_transport
        return {
            "packets.from_vehicle": vehicle.sent.total(),
            "packets.to_vehicle": vehicle.received.total(),
            "packets.lost": vehicle.lost.total() + control.lost.total(),
        }


def drive(conditions: Conditions, workspace: Workspace, name: str) -> Run:
    """Drives once.

    Args:
        conditions: What the drive meets.
        workspace: Generated code of its system.
        name: Name of the run.
    """
    made = Drive(conditions, workspace)
    made.start()
    made.run()
    return made.finish(name)
