"""Video of addresses that a vehicle told: fetched for a page that asks for it, and bounded.

The page loads nothing of other servers. A person asks for one address, whose host is shown before;
the server connects to that one, follows it nowhere else, and passes on what a picture can be.
"""

from __future__ import annotations

import asyncio
import secrets
import socket
import ssl
import time
from contextlib import suppress
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection
from threading import Lock
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from jausml.authoring.proposals.elements import AnswerError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

MOST_STREAMS = 2
MOST_EACH_SECOND = 4 * 2**20
"""Bytes of one stream."""

LONGEST_SILENCE = 5.0
"""Seconds for which it is waited for a server."""

_PIECE = 2**16
_LOOK = 1.0
"""Seconds from one look whether the address is still told to the next."""

_PORTS = {"http": "80", "https": "443"}
_WHOLE, _MOVED = 200, range(300, 400)
_KINDS = ("image/", "video/")
_PICTURES = "multipart/x-mixed-replace"
_DOCUMENT = "image/svg+xml"
"""What may hold programs."""


def connection_to(url: str, shown: str) -> tuple[HTTPConnection, str]:
    """Returns a connection that is not open yet, and what to ask it for.

    Args:
        shown: The host, with a port that is not the usual one, which the person has seen.

    Raises:
        AnswerError: It is no such address, or of another host.
    """
    if not url.isascii() or not url.isprintable() or any(each in url for each in " \\"):
        raise AnswerError("it is no address")
    try:
        parts = urlsplit(url)
        name, port = parts.hostname or "", parts.port
    except ValueError as error:
        raise AnswerError(f"it is no address: {error}") from error
    if parts.scheme not in _PORTS:
        raise AnswerError(f"{parts.scheme or 'it'} is neither http nor https")
    if not name or parts.netloc.lower().removesuffix(f":{_PORTS[parts.scheme]}") != shown:
        raise AnswerError(f"its host is not the one that was shown, {shown!a}")
    path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
    if parts.scheme == "http":
        return HTTPConnection(name, port, LONGEST_SILENCE), path
    context = ssl.create_default_context()
    return HTTPSConnection(name, port, timeout=LONGEST_SILENCE, context=context), path


def check(response: HTTPResponse) -> str:
    """Returns the type of what a server answers (`AnswerError`: it is not shown)."""
    if response.status in _MOVED:
        raise AnswerError(f"the server answers {response.status}: nothing is followed elsewhere")
    if response.status != _WHOLE:
        raise AnswerError(f"the server answers {response.status}")
    told = response.getheader("Content-Type", "")
    kind = told.partition(";")[0].strip().lower()
    if kind == _DOCUMENT or not (kind.startswith(_KINDS) or kind == _PICTURES):
        raise AnswerError(f"it is {kind or 'of no type'}, neither picture nor video")
    return told


class Stream:
    """One address that is being read; `close` may be called by any thread."""

    def __init__(self, page: int, url: str, shown: str, is_told: Callable[[], bool]) -> None:
        """Connects and asks, which takes a while.

        Args:
            is_told: Tells whether the vehicle still tells the address.

        Raises:
            AnswerError: It is not shown; the text says why.
        """
        self.page, self.ticket = page, secrets.token_urlsafe(32)
        self.was_taken = False
        self._is_told = is_told
        connection, path = connection_to(url, shown)
        try:
            connection.connect()
            self._socket: socket.socket = connection.sock
            connection.request("GET", path, headers={"Accept": "image/*, video/*, */*;q=0.1"})
            self._response = connection.getresponse()
            self.type = check(self._response)
        except (OSError, HTTPException, ValueError) as error:
            connection.close()
            raise AnswerError(str(error) or type(error).__name__) from error
        except AnswerError:
            connection.close()
            raise

    async def pieces(self) -> AsyncIterator[bytes]:
        """Yields what comes until either end is gone, not faster than it may."""
        due = look = time.monotonic()
        while piece := await asyncio.to_thread(self._read):
            yield piece
            now = time.monotonic()
            due = max(due, now) + len(piece) / MOST_EACH_SECOND
            await asyncio.sleep(due - now)
            if now - look > _LOOK:
                look = now
                if not self._is_told():
                    return

    def _read(self) -> bytes:
        try:
            return self._response.read1(_PIECE)
        except (OSError, HTTPException, ValueError, AttributeError):  # also: closed meanwhile
            return b""

    def close(self) -> None:
        """Reads no more: who waits for bytes is woken."""
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        with suppress(OSError, ValueError):
            self._response.close()


class Streams:
    """The streams of all pages; any thread may ask."""

    def __init__(self) -> None:
        """Reads none."""
        self._open: dict[str, Stream] = {}
        self._asked = 0
        self._lock = Lock()

    def open(self, page: int, url: str, shown: str, is_told: Callable[[], bool]) -> Stream:
        """Begins to read an address for a page (`AnswerError`: it is not shown)."""
        with self._lock:
            if len(self._open) + self._asked >= MOST_STREAMS:
                raise AnswerError(f"{MOST_STREAMS} streams are shown; hide one of them")
            self._asked += 1
        try:
            made = Stream(page, url, shown, is_told)
        except BaseException:
            with self._lock:
                self._asked -= 1
            raise
        with self._lock:
            self._asked -= 1
            self._open[made.ticket] = made
        return made

    def take(self, ticket: str) -> Stream | None:
        """Returns a stream to who has its ticket, once."""
        with self._lock:
            found = self._open.get(ticket)
            if found is None or found.was_taken:
                return None
            found.was_taken = True
            return found

    def close(self, ticket: str) -> None:
        """Ends a stream."""
        with self._lock:
            found = self._open.pop(ticket, None)
        if found is not None:
            found.close()

    def leave(self, page: int) -> None:
        """Ends all that a page sees."""
        with self._lock:
            tickets = [each.ticket for each in self._open.values() if each.page == page]
        for each in tickets:
            self.close(each)
