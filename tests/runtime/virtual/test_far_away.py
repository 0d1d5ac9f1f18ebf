"""Control and commands over a long way that loses a fifth and changes the order."""

import pytest
from sweeps import sweep

from jausml.runtime import (
    ComponentSettings,
    ControlState,
    Guard,
    JausAddress,
    JausComponent,
    Status,
)
from jausml.runtime.messages import SetTime
from jausml.runtime.virtual import Link, VirtualWorld
from tests.runtime.services.state_tables import V1_1, core_services

CORE = core_services(V1_1, "Transport", "Events", "AccessControl", "Management")
VEHICLE, OPERATOR = JausAddress(1, 1, 1), JausAddress(2, 1, 1)
PERIOD = 0.05
FAR = Link(delay=0.3, jitter=0.1, loss=0.2)


class Drive:
    """An operator that sends numbered commands while it may, and a vehicle that obeys.

    Attributes:
        obeyed: Numbers of the commands, in the order in which the vehicle took them.
        states: States of the control that the operator was told, from the first READY on.
        left: When the vehicle was not in READY afterwards.
        unsent: Commands that were not sent afterwards.
    """

    def __init__(self, world):
        self.world = world
        self.obeyed, self.states, self.left, self.unsent = [], [], [], 0
        vehicle = self.component(VEHICLE, CORE, control_timeout=2)
        vehicle.handle(SetTime, self.obey, when=Guard.READY)
        operator = self.component(OPERATOR, ())
        session = operator.control(VEHICLE, authority=127, on_change=self.states.append)
        world.run_until(lambda: session.state is ControlState.READY, limit=10.0)
        del self.states[:]
        for number in range(600):
            if session.state is ControlState.READY:
                stamp = SetTime.TimeStamp(minutes=number // 60, seconds=number % 60)
                operator.send(SetTime(time_stamp=stamp), VEHICLE)
            else:
                self.unsent += 1
            world.run_for(PERIOD)
            if vehicle.status is not Status.READY:
                self.left.append(world.now())

    def component(self, address, services, **settings):
        made = JausComponent(
            self.world.transport(out=FAR),
            address,
            name=str(address),
            services=services,
            settings=ComponentSettings(register_services=False, **settings),
        )
        made.start()
        return made

    def obey(self, message, _sender):
        self.obeyed.append(60 * message.time_stamp.minutes + message.time_stamp.seconds)


@pytest.mark.parametrize("seed", sweep(range(10), every=5))
def test_a_vehicle_stays_in_ready_and_obeys_in_order(seed):
    with VirtualWorld(seed) as world:
        drive = Drive(world)
    assert drive.left == []
    assert drive.states == []
    assert drive.unsent == 0
    assert drive.obeyed == sorted(set(drive.obeyed))
    assert len(drive.obeyed) > 380
