"""Messages of ListManager: linked lists of commands (SAE AS5710A)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, TypeAlias

from ..wire.codec import U8, U16, Counted, LongList, ShortList, unsigned
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message


@record("RequestIDRec")
@dataclass(slots=True)
class _RequestIDRec:
    """The id of a request, which its answer repeats."""

    request_id: U8 = 0


@record("ElementData")
@dataclass(slots=True)
class _ElementData:
    """The data of an element: a message, or bytes of a user-defined format."""

    format_index: Annotated[int, unsigned(1, upper=1)] = 0
    data: Annotated[bytes, Counted("H")] = b""


@record("ElementRec")
@dataclass(slots=True)
class _ElementRec:
    """An element of a list, with the UIDs of its neighbours."""

    element_uid: U16 = 0
    previous_uid: U16 = 0
    next_uid: U16 = 0
    element_data: _ElementData = field(default_factory=_ElementData)


# A dataclass would take an alias in its own body for a field: hence this base.
class _WithElements(Message):
    __slots__ = ()

    RequestIDRec: TypeAlias = _RequestIDRec
    ElementData: TypeAlias = _ElementData
    ElementRec: TypeAlias = _ElementRec


@message(0x041A)
@dataclass(slots=True, repr=False, eq=False)
class SetElement(_WithElements):
    """Adds elements to a list, or replaces them."""

    class ElementDataFormat(IntEnum):
        JAUS_MESSAGE = 0
        USER_DEFINED = 1

    request_id_rec: _RequestIDRec = field(default_factory=_RequestIDRec)
    element_list: ShortList[_ElementRec] = field(default_factory=list)


@message(0x041B)
@dataclass(slots=True, repr=False, eq=False)
class DeleteElement(_WithElements):
    """Deletes elements of a list."""

    @record("DeleteElement.DeleteElementRec")
    @dataclass(slots=True)
    class DeleteElementRec:
        """An element to delete; 65535 means all."""

        element_uid: U16 = 0

    request_id_rec: _RequestIDRec = field(default_factory=_RequestIDRec)
    delete_element_list: ShortList[DeleteElementRec] = field(default_factory=list)


@message(0x041C)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmElementRequest(Message):
    """Confirms SetElement or DeleteElement."""

    request_id: U8 = 0


@message(0x041D)
@dataclass(slots=True, repr=False, eq=False)
class RejectElementRequest(Message):
    """Rejects SetElement or DeleteElement, which have left the list unchanged."""

    class ResponseCode(IntEnum):
        INVALID_ELEMENT_ID = 1
        INVALID_PREVIOUS_ELEMENT = 2
        INVALID_NEXT_ELEMENT = 3
        UNSUPPORTED_ELEMENT_TYPE = 4
        ELEMENT_ID_NOT_FOUND = 5
        OUT_OF_MEMORY = 6
        UNSPECIFIED_ERROR = 7

    request_id: U8 = 0
    response_code: Annotated[int, unsigned(1, 1, 7)] = 1


@message(0x241A)
@dataclass(slots=True, repr=False, eq=False)
class QueryElement(Message):
    """Asks for an element of a list."""

    element_uid: U16 = 0


@message(0x241B)
class QueryElementList(Bodiless):
    __slots__ = ()


@message(0x241C)
class QueryElementCount(Bodiless):
    __slots__ = ()


@message(0x441A)
@dataclass(slots=True, repr=False, eq=False)
class ReportElement(_WithElements):
    """Reports an element of a list."""

    ElementDataFormat = SetElement.ElementDataFormat

    element_uid: U16 = 0
    previous_uid: U16 = 0
    next_uid: U16 = 0
    element_data: _ElementData = field(default_factory=_ElementData)


@message(0x441B)
@dataclass(slots=True, repr=False, eq=False)
class ReportElementList(Message):
    """Reports the UIDs of a list, in order."""

    @record("ReportElementList.ElementListRec")
    @dataclass(slots=True)
    class ElementListRec:
        """An element of a list."""

        element_uid: U16 = 0

    element_list: LongList[ElementListRec] = field(default_factory=list)


@message(0x441C)
@dataclass(slots=True, repr=False, eq=False)
class ReportElementCount(Message):
    """Reports the length of a list."""

    element_count: U16 = 0
