"""Serving: a port is taken, the address is told, and signals end it."""

from __future__ import annotations

import logging
import signal
import socket
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import uvicorn

from jausml.authoring.studio.app import Studio
from jausml.authoring.studio.page_socket import LARGEST_MESSAGE
from jausml.authoring.studio.security import Served

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jausml.authoring.studio.session import Session

PAGE = Path(__file__).resolve().parent / "page"
"""Where the built page lies; `make studio` builds it."""

_SECONDS_TO_END = 2


class PageMissingError(Exception):
    """The page was not built."""


def require_page() -> None:
    """Looks whether the page is there."""
    if not (PAGE / "index.html").is_file():
        raise PageMissingError(
            "the page of the studio is missing: run `make studio` in the checkout of jausml,"
            " or install the wheel that `make wheel` builds there"
        )


def serve(session: Session, host: str, port: int, opened: Callable[[str], None]) -> None:
    """Serves a session until SIGINT or SIGTERM comes; the main thread calls it.

    Args:
        opened: Is called with the address as soon as it can be opened.

    Raises:
        OSError: The port cannot be had.
    """
    if not host:
        raise ValueError("an empty host would be all addresses")
    host.encode("idna")
    # It tells of texts that it cannot understand at length, and its editor is told anyway.
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    with socket.create_server((host, port), family=_family(host)) as listener:
        bound, taken = listener.getsockname()[:2]
        served = Served(host, taken, bound)
        studio = Studio(session, served, PAGE)
        config = uvicorn.Config(
            studio.app(),
            http="h11",
            ws="websockets-sansio",
            ws_max_size=LARGEST_MESSAGE,
            ws_per_message_deflate=False,
            lifespan="on",
            access_log=False,
            log_level="warning",
            proxy_headers=False,
            server_header=False,
            timeout_graceful_shutdown=_SECONDS_TO_END,
        )
        server = uvicorn.Server(config)
        with _ended_by_signals(server):
            opened(studio.address)
            server.run(sockets=[listener])


def _family(host: str) -> socket.AddressFamily:
    return socket.AF_INET6 if ":" in host else socket.AF_INET


@contextmanager
def _ended_by_signals(server: uvicorn.Server) -> Iterator[None]:
    """Has signals end the server: before it looks for them, and when it raises them again."""

    def end(*_: object) -> None:
        server.should_exit = True

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(each, end) for each in signals]
    try:
        yield
    finally:
        for each, handler in zip(signals, before, strict=True):
            signal.signal(each, handler)
