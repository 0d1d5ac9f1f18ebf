"""The Management service: the states of a component, and its emergencies (AS5710)."""

from __future__ import annotations

from ..base.address import JausAddress
from ..base.api import JausError
from ..base.counters import LOGGER
from ..messages import (
    ClearEmergency,
    QueryStatus,
    ReportStatus,
    Reset,
    Resume,
    SetEmergency,
    Shutdown,
    Standby,
)
from ..wire.message import Message
from .access_control import AccessControlService, Reject
from .definitions import CORE, VERSION_1_1, Guard, Status
from .dispatch import Take
from .host import Host

# JAUS-DEVIATION: AS5710 lists 1 (STOP) alone; components made with the JAUS Tool Set send 0.
EMERGENCY_CODES = (0, 1)  # emergency codes that are taken for STOP; others are ignored

FINAL = (Status.FAILURE, Status.SHUTDOWN)
"""States that no message ends: an emergency on top of them leads back to them."""

PASSIVE = (Status.EMERGENCY, Status.FAILURE, Status.SHUTDOWN)
"""States in which a component controls no others: what it commands must stop with it."""

MAX_EMERGENCY_CLIENTS = 1024
"""Senders whose emergencies are remembered; a flood of false ones must not fill the memory."""

ABSENT_S = 10.0
"""Seconds of silence after which somebody at the robot may lift an emergency of a client."""


class EmergencyStandsError(JausError):
    """An emergency that may not be lifted."""


class ManagementService:
    """Keeps the state of the component (AS5710, Management, protocol behaviour).

    A component that provides Management v1.0 behaves as v1.0 says: after an emergency it goes on
    where it was, Reset needs Ready, and anyone may shut down or reset it in Emergency. Of either
    version, one that has failed or was shut down is so again after an emergency.
    """

    urns = frozenset([CORE + "Management"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._access = access = component.part(AccessControlService)
        self._emergencies: set[JausAddress] = set()
        self._watchers: dict[int, list[Take]] = {}
        self._is_1_0 = component.core_version("Management") < VERSION_1_1
        self._interrupted: tuple[Status, JausAddress | None, int] = (Status.STANDBY, None, 0)
        self.status = Status.INITIALIZE
        access.managed = False
        access.emergency_clients = self._emergencies
        access.on_lost = self.stand_by

    def attach(self) -> None:
        """Takes the messages of Management."""
        component = self._component
        component.handle(Resume, self._resume, when=Guard.CONTROLLED)
        component.handle(Standby, lambda *_: self.stand_by(), when=Guard.CONTROLLED)
        component.handle(Shutdown, self._shutdown, when=self._who_ends)
        component.handle(Reset, self._reset, when=self._who_ends)
        component.handle(SetEmergency, self._set_emergency)
        component.handle(ClearEmergency, self._clear_emergency)
        component.provide(QueryStatus, ReportStatus, lambda *_: ReportStatus(self.status))

    def watch_emergency(self, message_class: type[Message], take: Take) -> None:
        """Gives an action SetEmergency when an emergency has begun, ClearEmergency when it ended.

        That is not each such message: others may have set an emergency too, and a person at the
        robot may lift it. What is given is encoded, from whoever made the difference.
        """
        self._watchers.setdefault(message_class.CODE, []).append(take)

    def _tell(self, sender: JausAddress, *, active: bool) -> None:
        """Tells connections, then the hook, that an emergency has begun or ended."""
        message_class = SetEmergency if active else ClearEmergency
        for take in self._watchers.get(message_class.CODE, ()):
            take(message_class(emergency_code=message_class.EmergencyCode.STOP).encode(), sender)
        self._component.call(self._component.on_emergency, active)

    def initialize(self) -> None:
        """Passes through Init to Standby."""
        self._emergencies.clear()
        self._enter(Status.INITIALIZE)
        self._component.call(self._component.on_initialize)
        # The hook may have reported a failure.
        if self.status is Status.INITIALIZE:
            self._enter(Status.STANDBY)

    def fail(self, reason: str) -> None:
        """Enters Failure from any state and lets go of the controller."""
        # JAUS-DEVIATION: AS5710 ignores the internal event Failure in Emergency; a component that
        # is broken must not be in Standby again when the emergency is cleared.
        self._component.counters.count("component.failed", reason)
        self._enter(Status.FAILURE)
        self._access.drop(Reject.CONTROL_RELEASED)

    def shut_down(self, reject: Reject = Reject.CONTROL_RELEASED) -> None:
        """Enters Shutdown and lets go of the controller."""
        if self.status is Status.SHUTDOWN:
            return
        self._enter(Status.SHUTDOWN)
        self._access.drop(reject)
        self._component.shut_down()

    def _resume(self, _message: Resume, _sender: JausAddress) -> None:
        if self.status is Status.STANDBY:
            self._enter(Status.READY)

    def stand_by(self) -> None:
        """Leaves Ready for Standby; no effect in another state."""
        if self.status is Status.READY:
            self._enter(Status.STANDBY)

    def withdraw(self) -> None:
        """Leaves Ready for Standby and tells the controller that there is no control to have."""
        self.stand_by()
        self._access.drop(Reject.NOT_AVAILABLE)

    def _who_ends(self, _message: Message) -> Guard:
        """Returns who may send Shutdown and Reset now.

        In the Emergency of v1.1 nobody may: it has no controller, and lasts until the last
        emergency is cleared.
        """
        anyone = self._is_1_0 and self.status is Status.EMERGENCY
        return Guard.ANY if anyone else Guard.CONTROLLED

    def _shutdown(self, _message: Shutdown, sender: JausAddress) -> None:
        if self.status not in (Status.READY, Status.EMERGENCY):
            self._ignored("management.shutdown_ignored", sender)
            return
        LOGGER.info("%s is shut down by %s", self._component.address, sender)
        self.shut_down(Reject.CONTROL_RELEASED if self._is_1_0 else Reject.NOT_AVAILABLE)

    def _reset(self, _message: Reset, sender: JausAddress) -> None:
        if self.status is Status.STANDBY and self._is_1_0:
            self._ignored("management.reset_ignored", sender)
            return
        was_emergency = self.status is Status.EMERGENCY
        if was_emergency and self._interrupted[0] in FINAL:
            # JAUS-DEVIATION: AS5710 v1.0 resets from any emergency; a component that has failed or
            # was shut down, which no Reset revives, must not be revived by way of an emergency.
            self._ignored("management.reset_ignored", sender)
            return
        self._enter(Status.INITIALIZE)
        self._access.drop(Reject.CONTROL_RELEASED)
        if was_emergency:
            self._tell(sender, active=False)
        if self.status is Status.INITIALIZE:  # no hook has reported a failure meanwhile
            self.initialize()

    def _ignored(self, name: str, sender: JausAddress) -> None:
        """Counts what the controller demands and the standard has no transition for."""
        self._component.counters.count(name, f"of {sender} in {self.status.name}")

    def _set_emergency(self, message: SetEmergency, sender: JausAddress) -> None:
        if message.emergency_code not in EMERGENCY_CODES:
            self._component.counters.count(
                "management.bad_emergency_code", f"{message.emergency_code} of {sender}"
            )
            return
        if len(self._emergencies) < MAX_EMERGENCY_CLIENTS:
            self._emergencies.add(sender)
        if self.status is not Status.EMERGENCY:
            LOGGER.warning("%s: emergency set by %s", self._component.address, sender)
            # Of the first emergency alone: a second one has interrupted nothing.
            self._interrupted = (self.status, self._access.controller, self._access.authority)
            self._enter(Status.EMERGENCY)
            # JAUS-DEVIATION: AS5710 ends control with the emergency. Clients that are made with the
            # JAUS Tool Set count on keeping it, and ask for it again without end.
            if self._component.settings.control_survives_emergency:
                self._access.kept = True
            else:
                self._access.drop(Reject.CONTROL_RELEASED if self._is_1_0 else Reject.NOT_AVAILABLE)
            self._tell(sender, active=True)

    def _clear_emergency(self, message: ClearEmergency, sender: JausAddress) -> None:
        if message.emergency_code not in EMERGENCY_CODES or sender not in self._emergencies:
            self._component.counters.add("management.clear_ignored")
            return
        self._emergencies.discard(sender)
        if self.status is Status.EMERGENCY and not self._emergencies:
            LOGGER.warning("%s: emergency cleared", self._component.address)
            self._leave_emergency()
            self._tell(sender, active=False)

    def _leave_emergency(self) -> None:
        """Goes to Standby without a controller; in v1.0, back to what the emergency interrupted."""
        status, controller, authority = self._interrupted
        # JAUS-DEVIATION: some definitions of v1.1 go back too, with the same controller; to stand
        # still is what those of the IOP say, and what is safe. For the same reason a component
        # that has failed or was shut down goes back: nobody shall revive it by an emergency.
        if not self._is_1_0 and status not in FINAL:
            self._enter(Status.STANDBY)
            return
        if controller is not None and self._access.controller is None:
            self._access.restore(controller, authority)
        if self.status is Status.EMERGENCY:  # no hook has reported a failure meanwhile
            self._enter(status)

    def check_lift(self, clients: JausAddress) -> list[JausAddress]:
        """Returns whose emergencies somebody at the robot may lift.

        A stop needs no proof of who sends it, so that anybody can set an emergency, also in a name
        that nobody has. AS5710 lets the same name alone clear it. A person at the robot must have
        a way out, yet not against an operator who is there: those must have been silent.

        Args:
            clients: Who set them; a wildcard means several.

        Raises:
            EmergencyStandsError: Nobody of them set one, or somebody was heard a moment ago.
        """
        meant = [emergency for emergency in self._emergencies if clients.matches(emergency)]
        if not meant:
            known = ", ".join(map(str, sorted(self._emergencies))) or "nobody"
            raise EmergencyStandsError(f"no emergency was set by {clients}; by {known}")
        for address in meant:
            silent = self._component.transport.silence_of(address)
            if silent < ABSENT_S:
                raise EmergencyStandsError(
                    f"{address} was heard {silent:.1f} s ago: it clears its emergency itself, "
                    f"or must be silent for {ABSENT_S:g} s"
                )
        return meant

    def lift(self, clients: JausAddress) -> None:
        """Lifts the emergencies of clients who are not there any more; see ``check_lift``.

        When it was the last one, the component is in Standby without a controller, in v1.0 as
        well: nothing moves before somebody takes control and resumes it.
        """
        for address in self.check_lift(clients):
            self._emergencies.discard(address)
            self._component.counters.count("management.emergency_lifted", f"that of {address}")
        if self.status is Status.EMERGENCY and not self._emergencies:
            LOGGER.warning("%s: the last emergency was lifted", self._component.address)
            status = self._interrupted[0]
            if self._access.kept:
                self._access.drop(Reject.CONTROL_RELEASED)
            self._enter(status if status in FINAL else Status.STANDBY)
            self._tell(self._component.address, active=False)

    def _enter(self, status: Status) -> None:
        former, self.status = self.status, status
        if former is status:
            return
        self._access.managed = status in (Status.STANDBY, Status.READY)
        self._access.kept = False
        if former is Status.READY:
            self._component.call(self._component.on_not_ready)
            self._component.permissions_changed()
        elif status is Status.READY:
            self._component.call(self._component.on_ready)
        self._component.core_state_changed()
        # A hook may have reported a failure meanwhile.
        self._component.permit_control(self.status not in PASSIVE)
        self._component.report_changed(ReportStatus)
