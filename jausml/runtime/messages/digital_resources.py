"""Messages of Digital Resource Discovery: where streams and files are (IOP)."""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from typing import Annotated

from ..wire.codec import U8, U16, U32, ShortList, Text, unsigned
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message

_RTSP, _MPEG2_TS, _FTP, _SFTP, _FTP_OVER_SSH, _HTTP, _HTTPS, _SCP = range(8)

_SERVER_TYPES = {
    "rtsp": _RTSP,
    "udp": _MPEG2_TS,
    "rtp": _MPEG2_TS,
    "ftp": _FTP,
    "sftp": _SFTP,
    "http": _HTTP,
    "https": _HTTPS,
    "scp": _SCP,
}
"""Kinds of servers by the scheme of their URLs."""

_LONGEST_URL = 255


def server_type(url: str) -> int:
    """Returns the kind of server that a URL leads to.

    Raises:
        ValueError: It has a scheme that the IOP does not know, or is too long to be told.
    """
    scheme = url.partition("://")[0].lower()
    if scheme not in _SERVER_TYPES or "://" not in url:
        known = ", ".join(_SERVER_TYPES)
        raise ValueError(f"{url} is no URL of a digital resource; it begins with {known}")
    if len(url) > _LONGEST_URL or not url.isascii():
        raise ValueError(f"{url} has more than {_LONGEST_URL} characters, or others than ASCII")
    return _SERVER_TYPES[scheme]


@record("DigitalResourceEndpointRec")
@dataclass(slots=True)
class Endpoint:
    """Where a stream or file is, and which resource of which component it is."""

    server_type: Annotated[int, unsigned(1, upper=_SCP)] = 0
    server_url: Text = ""
    jaus_id: U32 | None = None
    resource_id: U16 | None = None


@record("RequestIDRec")
@dataclass(slots=True)
class RequestIDRec:
    """The request that an answer is to name."""

    request_id: U8 = 0


@message(0xE702)
class QueryDigitalResourceEndpoint(Bodiless):
    __slots__ = ()


@message(0xE703)
@dataclass(slots=True, repr=False, eq=False)
class RegisterDigitalResourceEndpoint(Message):
    """Adds an endpoint to those that are known."""

    request_id_rec: RequestIDRec = field(default_factory=RequestIDRec)
    endpoint: Endpoint = field(default_factory=Endpoint)


@message(0xE704)
@dataclass(slots=True, repr=False, eq=False)
class RemoveDigitalResourceEndpoint(Message):
    """Removes an endpoint by the id that it was confirmed with."""

    id: U8 = 0
    request_id: U8 = 0


@message(0xF702)
@dataclass(slots=True, repr=False, eq=False)
class ReportDigitalResourceEndpoint(Message):
    """The endpoints that are known."""

    endpoints: ShortList[Endpoint] = field(default_factory=list)


@message(0xF703)
@dataclass(slots=True, repr=False, eq=False)
class ConfirmDigitalResourceEndpoint(Message):
    """Answers a registration and a removal."""

    id: U8 = 0
    request_id: U8 = 0
