"""Messages of the DigitalResourceDiscovery service (IOP)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from typing import Annotated

from ..wire.codec import U8, U16, U32, ShortList, Text, unsigned
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message


@record("DigitalResourceEndpointRec")
@dataclass(slots=True)
class Endpoint:
    """The URL of a stream or file, and its component and resource."""

    server_type: Annotated[int, unsigned(1, upper=7)] = 0
    server_url: Text = ""
    jaus_id: U32 | None = None
    resource_id: U16 | None = None


@record("RequestIDRec")
@dataclass(slots=True)
class RequestIDRec:
    """The id of a request, which its answer repeats."""

    request_id: U8 = 0


@message(0xE702)
class QueryDigitalResourceEndpoint(Bodiless):
    __slots__ = ()


@message(0xE703)
@dataclass(slots=True, repr=False, eq=False)
class RegisterDigitalResourceEndpoint(Message):
    """Adds an endpoint to the registry."""

    request_id_rec: RequestIDRec = field(default_factory=RequestIDRec)
    endpoint: Endpoint = field(default_factory=Endpoint)


@message(0xE704)
@dataclass(slots=True, repr=False, eq=False)
class RemoveDigitalResourceEndpoint(Message):
    """Removes an endpoint by the id of its confirmation."""

    id: U8 = 0
    request_id: U8 = 0


@message(0xF702)
@dataclass(slots=True, repr=False, eq=False)
class ReportDigitalResourceEndpoint(Message):
    """Reports all endpoints of the registry."""

    endpoints: ShortList[Endpoint] = field(default_factory=list)


@message(0xF703)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmDigitalResourceEndpoint(Message):
    """Answers a registration and a removal."""

    id: U8 = 0
    request_id: U8 = 0
