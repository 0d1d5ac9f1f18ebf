"""Faults that are put into the abstract machines are found, each with a way that leads to it."""

from dataclasses import replace
from pathlib import Path

import pytest
from generated import model_in
from sweeps import sweep

from jausml.generation.target import system_of
from jausml.model_checking.bridge_products import CommandingProduct, ObeyingProduct
from jausml.model_checking.checking import check_subject
from jausml.model_checking.runtime_machines import (
    EMERGENCY,
    READY,
    STANDBY,
    CommandConnection,
    CoreServices,
)
from jausml.model_checking.search import CONTROL, DEADLOCK, LATE_STOP, LIVELOCK, Bounds
from jausml.model_checking.systems import Subject, subjects_of

TOLD = Bounds(100_000, lambda: False)
CLIENTS = ("a client", "an operator of more authority")
AUTHORITIES = dict(zip(CLIENTS, (10, 20), strict=True))


def obeying(
    services=CoreServices, connection_state=CommandConnection, guard="READY", silence=2, lapse=5
):
    return ObeyingProduct(
        "front",
        "SetSpeed",
        services(AUTHORITIES, 5, lapse),
        connection_state(guard, silence),
        CLIENTS,
    )


def commanding(product=CommandingProduct, services=CoreServices):
    return product(
        "station",
        "rover",
        "SetSpeed",
        services({"station": 10, CLIENTS[1]: 20}, 5, 5),
        CoreServices(),
        CommandConnection("READY", 2, to_ros=False),
        patience=4,
        rival=CLIENTS[1],
    )


def rules_of(product):
    outcome = check_subject(Subject("tested", None, product, 0.5), TOLD)
    assert outcome.is_complete
    for counter_example in outcome.found:
        assert counter_example.moments or "from the start on" in counter_example.message
    return {counter_example.rule for counter_example in outcome.found}


@pytest.mark.parametrize("guard", ["READY", "CONTROLLED", "ANY"])
def test_what_is_right_holds(guard):
    assert rules_of(obeying(guard=guard)) == set()


def test_a_peer_that_is_right_holds():
    assert rules_of(commanding()) == set()


# ---------------------------------------------------------------------- faults of the core services


class ObeysAnybody(CoreServices):
    def allows(self, core, guard, *_):
        return core.status == READY or (guard != "READY" and core.status == STANDBY)


class ObeysInStandby(CoreServices):
    def allows(self, core, _, sender):
        return super().allows(core, "CONTROLLED", sender)


class ObeysInEmergency(CoreServices):
    def set_emergency(self, core, sender):
        return core._replace(emergencies=core.emergencies | {sender})


class GivesControlToLess(CoreServices):
    def request(self, core, sender):
        return (
            core._replace(controller=sender, lapses_in=self.timeout) if core.is_available else core
        )


class GivesControlBelowTheDefault(CoreServices):
    def request(self, core, sender):
        return replace_default(self).request(core, sender)


def replace_default(services):
    return CoreServices(services.authorities, 0, services.timeout)


class NeverLapses(CoreServices):
    def tick(self, core):
        return core


class LapsesLater(CoreServices):
    def request(self, core, sender):
        after = super().request(core, sender)
        return after._replace(lapses_in=self.timeout + 3) if after.lapses_in else after


class StaysReadyWithoutControl(CoreServices):
    def drop(self, core):
        return super().drop(core)._replace(status=core.status)


class NeverResumes(CoreServices):
    def resume(self, core, *_):
        return core


class KeepsEmergency(CoreServices):
    def clear_emergency(self, core, *_):
        return core


class ResumesIntoStandby(CoreServices):
    """A transition that is turned."""

    def resume(self, core, sender):
        after = super().resume(core, sender)
        return after._replace(status=STANDBY) if after is not core else core

    def standby(self, core, sender):
        is_obeyed = self.allows(core, "CONTROLLED", sender)
        return core._replace(status=EMERGENCY) if is_obeyed else core


CORE_FAULTS = [
    pytest.param(ObeysAnybody, {}, CONTROL, id="the check of control dropped"),
    pytest.param(ObeysInStandby, {}, CONTROL, id="the check of Ready dropped"),
    pytest.param(ObeysInEmergency, {}, CONTROL, id="an emergency ignored"),
    pytest.param(GivesControlToLess, {}, CONTROL, id="the check of authority dropped"),
    pytest.param(NeverLapses, {"silence": 0}, LATE_STOP, id="control that never lapses"),
    pytest.param(NeverLapses, {}, LIVELOCK, id="control that a client takes to its grave"),
    pytest.param(LapsesLater, {"silence": 0}, LATE_STOP, id="control that lapses too late"),
    pytest.param(StaysReadyWithoutControl, {}, CONTROL, id="Ready without control"),
    pytest.param(NeverResumes, {}, DEADLOCK, id="Resume without effect"),
    pytest.param(KeepsEmergency, {}, DEADLOCK, id="an emergency that nothing clears"),
    pytest.param(ResumesIntoStandby, {}, DEADLOCK, id="a transition turned"),
]


@pytest.mark.parametrize(("services", "other", "rule"), sweep(CORE_FAULTS, every=3, rest=1))
def test_a_fault_of_the_core_services_is_found(services, other, rule):
    assert rule in rules_of(obeying(services, **other))


def test_control_below_the_default_authority_is_found():
    product = replace(
        obeying(GivesControlBelowTheDefault),
        services=GivesControlBelowTheDefault({CLIENTS[0]: 1, CLIENTS[1]: 2}, 5, 5),
    )
    assert CONTROL in rules_of(product)


# ---------------------------------------------------------------------- faults of connections


class ForgetsControl(CommandConnection):
    def follow(self, connection_state, *_):
        return connection_state


class ForgetsTakeover(CommandConnection):
    def follow(self, connection_state, former, core):
        is_taken = former.controller and core.controller and former.controller != core.controller
        return connection_state if is_taken else super().follow(connection_state, former, core)


class ForgetsEmergency(CommandConnection):
    def follow(self, connection_state, former, core):
        return (
            connection_state
            if core.status == EMERGENCY
            else super().follow(connection_state, former, core)
        )


class NeverHalts(CommandConnection):
    def _halt(self, connection_state, **_):
        return connection_state._replace(is_halted=False)


class NeverSilent(CommandConnection):
    def tick(self, connection_state):
        return connection_state


class SilentLate(CommandConnection):
    def take(self, connection_state):
        after = super().take(connection_state)
        return after._replace(silent_in=after.silent_in + 1) if after.silent_in else after


class StopsForGood(CommandConnection):
    """After the first stop nothing passes any more."""

    def stop(self, connection_state):
        return super().stop(connection_state)._replace(is_halted=True)

    def follow(self, connection_state, former, core):
        return (
            connection_state
            if connection_state.is_halted
            else super().follow(connection_state, former, core)
        )


CONNECTION_FAULTS = [
    pytest.param(ForgetsControl, {}, CONTROL, id="a stop left out when control is lost"),
    pytest.param(ForgetsTakeover, {}, CONTROL, id="a stop left out when another takes over"),
    pytest.param(ForgetsEmergency, {}, CONTROL, id="a stop left out in an emergency"),
    pytest.param(NeverHalts, {"guard": "ANY"}, CONTROL, id="a halt left out"),
    pytest.param(NeverSilent, {}, LATE_STOP, id="silence that nobody minds"),
    pytest.param(SilentLate, {}, LATE_STOP, id="a time-out longer than stated"),
    pytest.param(StopsForGood, {}, DEADLOCK, id="a stop that nothing ends"),
]


@pytest.mark.parametrize(
    ("connection_state", "other", "rule"), sweep(CONNECTION_FAULTS, every=3, rest=1)
)
def test_a_fault_of_a_connection_is_found(connection_state, other, rule):
    assert rule in rules_of(obeying(connection_state=connection_state, **other))


# ---------------------------------------------------------------------- faults between two


class SendsAStopOnce(CommandingProduct):
    """What the bridge did: a stop that was lost on the way was given up."""

    def _renewed(self, state):
        peer = self.services.request(state.peer, self.bridge)
        if not self._may_command(state) or peer.controller != self.bridge:
            return super()._renewed(state)
        was_lost = not state.believed
        state = state._replace(peer=self.services.resume(peer, self.bridge), lost_in=self.patience)
        state = state._replace(believed=state.peer.status)
        return self._stop_sent(state) if was_lost else state


class CommandsInEmergency(CommandingProduct):
    def _own_changed(self, state, own):
        return state._replace(own=own)


class LeavesTheCommand(CommandingProduct):
    """It commands nothing more, and tells the peer nothing."""

    def _own_changed(self, state, own):
        after = super()._own_changed(state, own)
        return state._replace(own=own, connection_state=after.connection_state)


class NeverAsksAgain(CommandingProduct):
    def _renewed(self, state):
        return state


class PeerKeepsMoving(CommandingProduct):
    def _peer_changed(self, state, peer):
        moves = state.is_moving
        return super()._peer_changed(state, peer)._replace(is_moving=moves)


BETWEEN = [
    pytest.param(SendsAStopOnce, LATE_STOP, id="a stop that is lost on the way"),
    pytest.param(CommandsInEmergency, CONTROL, id="commands in an emergency"),
    pytest.param(LeavesTheCommand, CONTROL, id="a command left when the bridge halts"),
    pytest.param(NeverAsksAgain, DEADLOCK, id="control that is never asked for"),
    pytest.param(PeerKeepsMoving, CONTROL, id="a peer that goes on without control"),
]


@pytest.mark.parametrize(("product", "rule"), BETWEEN)
def test_a_fault_between_two_is_found(product, rule):
    assert rule in rules_of(commanding(product))


@pytest.mark.parametrize(
    ("services", "rule"),
    [
        pytest.param(NeverLapses, LATE_STOP, id="control that never lapses"),
        pytest.param(LapsesLater, LATE_STOP, id="control that lapses too late"),
        pytest.param(ObeysAnybody, CONTROL, id="the check of control dropped"),
        pytest.param(NeverResumes, DEADLOCK, id="Resume without effect"),
    ],
)
def test_a_fault_of_a_peer_is_found(services, rule):
    assert rule in rules_of(commanding(services=services))


# ---------------------------------------------------------------------- faults of a model

ROVER = (Path(__file__).with_name("rover.ros2jaus")).read_text(encoding="utf-8")


def found_in(text, tmp_path, name):
    model = model_in(tmp_path, text, "rover.ros2jaus")
    (subject,) = [
        candidate for candidate in subjects_of(system_of(model)) if candidate.name == name
    ]
    return {counter_example.rule for counter_example in check_subject(subject, TOLD).found}


MODEL_FAULTS = [
    ("controlTimeout: 3\n    provides: PrimitiveDriver", "front.speed", {LATE_STOP, LIVELOCK}),
    (
        "controlTimeout: 3\n    provides: VelocityStateDriver",
        "station.velocity to rover",
        {LATE_STOP},
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(("stated", "name", "rules"), MODEL_FAULTS)
def test_a_time_out_left_out_of_a_model_is_found(stated, name, rules, tmp_path):
    assert found_in(ROVER, tmp_path, name) == set()
    without = ROVER.replace(stated, stated.replace("controlTimeout: 3", "controlTimeout: 0"))
    assert without != ROVER
    assert found_in(without, tmp_path, name) == rules
