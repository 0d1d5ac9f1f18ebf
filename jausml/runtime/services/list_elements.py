"""Elements of lists for services and clients (AS5710, ListManager)."""

from __future__ import annotations

from dataclasses import dataclass

# Message codes of the elements of each list driver (AS6009, manipulator set).
ELEMENTS_OF_DRIVERS = {
    "urn:jaus:jss:mobility:GlobalWaypointListDriver": 0x040C,
    "urn:jaus:jss:mobility:LocalWaypointListDriver": 0x040D,
    "urn:jaus:jss:mobility:GlobalPathSegmentDriver": 0x040F,
    "urn:jaus:jss:mobility:LocalPathSegmentDriver": 0x0410,
    "urn:jaus:jss:manipulator:ManipulatorJointPositionsListDriver": 0x0602,
    "urn:jaus:jss:manipulator:ManipulatorEndEffectorPoseListDriver": 0x0610,
}


@dataclass(frozen=True)
class ListElement:
    """One element of a list."""

    uid: int  # identifier, 1 to 65534, independent of the order
    previous_uid: int = 0  # 0 in the first element
    next_uid: int = 0  # 0 in the last element; that of the first one in a circular list
    data: bytes = b""  # an encoded message, or bytes of a format of the user
    data_format: int = 0  # 0 for a JAUS message, 1 for a format of the user (AS5710, SetElement)

    @property
    def message_code(self) -> int | None:
        """Code of the message in the element; None for other formats."""
        if self.data_format != 0 or len(self.data) < 2:
            return None
        return int.from_bytes(self.data[:2], "little")
