"""Elements of lists, as services and clients know them (AS5710, ListManager)."""

from __future__ import annotations

from dataclasses import dataclass

ELEMENTS_OF_DRIVERS = {
    "urn:jaus:jss:mobility:GlobalWaypointListDriver": 0x040C,
    "urn:jaus:jss:mobility:LocalWaypointListDriver": 0x040D,
    "urn:jaus:jss:mobility:GlobalPathSegmentDriver": 0x040F,
    "urn:jaus:jss:mobility:LocalPathSegmentDriver": 0x0410,
    "urn:jaus:jss:manipulator:ManipulatorJointPositionsListDriver": 0x0602,
    "urn:jaus:jss:manipulator:ManipulatorEndEffectorPoseListDriver": 0x0610,
}
"""Message code of the elements that each list driver takes (AS6009, manipulator set)."""


@dataclass(frozen=True)
class ListElement:
    """One element of a list."""

    uid: int  # identifier, 1 to 65534; says nothing about the order
    previous_uid: int = 0  # element before it; 0 in the first element
    # Element after it; 0 in the last element, the first element's in the last one of a circular
    # list.
    next_uid: int = 0
    data: bytes = b""  # what the element is: an encoded message, or bytes of the user's own format
    data_format: int = 0  # 0 for a JAUS message, 1 for a format of the user (AS5710, SetElement)

    @property
    def message_code(self) -> int | None:
        """Code of the message that the element is; None for other formats."""
        if self.data_format != 0 or len(self.data) < 2:
            return None
        return int.from_bytes(self.data[:2], "little")
