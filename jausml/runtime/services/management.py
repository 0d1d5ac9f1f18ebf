"""The Management service: the state of a component, and its emergencies (AS5710)."""

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

# JAUS-DEVIATION: AS5710 only lists 1 (STOP); components made with the JAUS Tool Set send 0.
EMERGENCY_CODES = (0, 1)  # emergency codes for STOP; others are ignored
FINAL = (Status.FAILURE, Status.SHUTDOWN)  # states that no message ends, even after an emergency
PASSIVE = (Status.EMERGENCY, *FINAL)  # states in which the component may not control others
MAX_EMERGENCY_CLIENTS = 1024  # clients that are stored; false ones must not fill the memory
ABSENT_S = 10.0  # seconds of silence of a client before a person may lift its emergency


class EmergencyStandsError(JausError):
    """An emergency must not be lifted."""


class ManagementService:
    """Keeps the state of the component (AS5710, Management, protocol behaviour).

    With Management v1.0, a component returns to its former state after an emergency, Reset requires
    Ready, and every component may shut it down or reset it in Emergency. In both versions,
    Failure and Shutdown are entered again after an emergency.
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
        component.handle(Shutdown, self._shutdown, when=self._end_guard)
        component.handle(Reset, self._reset, when=self._end_guard)
        component.handle(SetEmergency, self._set_emergency)
        component.handle(ClearEmergency, self._clear_emergency)
        component.provide(QueryStatus, ReportStatus, lambda *_: ReportStatus(self.status))

    def watch_emergency(self, message_class: type[Message], take: Take) -> None:
        """Calls `take` with SetEmergency when an emergency begins, or ClearEmergency when it ends.

        It is not called for each such message, since other clients may have set the emergency too.
        The message is encoded, and its sender is the client that caused the change.
        """
        self._watchers.setdefault(message_class.CODE, []).append(take)

    def _report_emergency(self, sender: JausAddress, *, active: bool) -> None:
        """Calls the watchers, then the hook, at the begin or end of an emergency."""
        message_class = SetEmergency if active else ClearEmergency
        for take in self._watchers.get(message_class.CODE, ()):
            take(message_class(emergency_code=message_class.EmergencyCode.STOP).encode(), sender)
        self._component.call(self._component.on_emergency, active)

    def initialize(self) -> None:
        """Goes through Init to Standby, or Failure if the hook reports one."""
        self._emergencies.clear()
        self._enter(Status.INITIALIZE)
        self._component.call(self._component.on_initialize)
        if self.status is Status.INITIALIZE:
            self._enter(Status.STANDBY)

    def fail(self, reason: str) -> None:
        """Enters Failure from any state and ends control."""
        # JAUS-DEVIATION: AS5710 ignores the internal event Failure in Emergency; but a broken
        # component must not enter Standby when the emergency is cleared.
        self._component.counters.count("component.failed", reason)
        self._enter(Status.FAILURE)
        self._access.drop(Reject.CONTROL_RELEASED)

    def shut_down(self, reject: Reject = Reject.CONTROL_RELEASED) -> None:
        """Enters Shutdown and ends control."""
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
        """Leaves Ready for Standby and ends control, as it is not available."""
        self.stand_by()
        self._access.drop(Reject.NOT_AVAILABLE)

    def _end_guard(self, _message: Message) -> Guard:
        """Returns the guard of Shutdown and Reset.

        In the Emergency of v1.1 no component may send them, as there is no controller.
        """
        is_open = self._is_1_0 and self.status is Status.EMERGENCY
        return Guard.ANY if is_open else Guard.CONTROLLED

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
            # JAUS-DEVIATION: AS5710 v1.0 resets from any emergency; but an emergency must not be a
            # way out of Failure or Shutdown, which Reset does not end.
            self._ignored("management.reset_ignored", sender)
            return
        self._enter(Status.INITIALIZE)
        self._access.drop(Reject.CONTROL_RELEASED)
        if was_emergency:
            self._report_emergency(sender, active=False)
        if self.status is Status.INITIALIZE:  # no hook has reported a failure meanwhile
            self.initialize()

    def _ignored(self, name: str, sender: JausAddress) -> None:
        """Counts a command for which the standard has no transition."""
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
            # Only by the first emergency.
            self._interrupted = (self.status, self._access.controller, self._access.authority)
            self._enter(Status.EMERGENCY)
            # JAUS-DEVIATION: AS5710 ends control in an emergency. Clients made with the JAUS Tool
            # Set expect to keep it, and would request it again without end.
            if self._component.settings.control_survives_emergency:
                self._access.kept = True
            else:
                self._access.drop(Reject.CONTROL_RELEASED if self._is_1_0 else Reject.NOT_AVAILABLE)
            self._report_emergency(sender, active=True)

    def _clear_emergency(self, message: ClearEmergency, sender: JausAddress) -> None:
        if message.emergency_code not in EMERGENCY_CODES or sender not in self._emergencies:
            self._component.counters.add("management.clear_ignored")
            return
        self._emergencies.discard(sender)
        if self.status is Status.EMERGENCY and not self._emergencies:
            LOGGER.warning("%s: emergency cleared", self._component.address)
            self._leave_emergency()
            self._report_emergency(sender, active=False)

    def _leave_emergency(self) -> None:
        """Goes to Standby without a controller; in v1.0, to the former state and controller."""
        status, controller, authority = self._interrupted
        # JAUS-DEVIATION: in some definitions of v1.1 the former state and controller return too;
        # those of the IOP say Standby, which is safe. Failure and Shutdown return in both, since an
        # emergency must not be a way out of them.
        if not self._is_1_0 and status not in FINAL:
            self._enter(Status.STANDBY)
            return
        if controller is not None and self._access.controller is None:
            self._access.restore(controller, authority)
        if self.status is Status.EMERGENCY:  # no hook has reported a failure meanwhile
            self._enter(status)

    def check_lift(self, clients: JausAddress) -> list[JausAddress]:
        """Returns the clients whose emergencies a person at the robot may lift.

        Every component can set an emergency, even with a forged address, and in AS5710 only that
        address can clear it. So a person may lift it, but not against a client that is present:
        each must have been silent for `ABSENT_S`.

        Args:
            clients: The clients that set them; a wildcard means several.

        Raises:
            EmergencyStandsError: None of the clients has set one, or one was heard lately.
        """
        matching = [client for client in self._emergencies if clients.matches(client)]
        if not matching:
            known = ", ".join(map(str, sorted(self._emergencies))) or "nobody"
            raise EmergencyStandsError(f"no emergency was set by {clients}; by {known}")
        for address in matching:
            silent = self._component.transport.silence_of(address)
            if silent < ABSENT_S:
                raise EmergencyStandsError(
                    f"{address} was heard {silent:.1f} s ago: it clears its emergency itself, "
                    f"or must be silent for {ABSENT_S:g} s"
                )
        return matching

    def lift(self, clients: JausAddress) -> None:
        """Lifts the emergencies of clients that have gone; raises as ``check_lift``.

        After the last one the component is in Standby without a controller, also in v1.0.
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
            self._report_emergency(self._component.address, active=False)

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
