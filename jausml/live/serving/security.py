"""Access to a server: hosts, origins, tokens, and the headers of each answer.

The threats are told in docs/explanation/threat-model.md.
"""

from __future__ import annotations

import hmac
import ipaddress
import secrets
import socket
from dataclasses import dataclass

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self'; "
        "connect-src 'self'; worker-src 'self'; img-src 'self' data:; "
        "base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'"
    ),
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""Headers of each answer."""

_METHODS = ("GET", "HEAD")
_POLICY_VIOLATION = 1008


class Token:
    """The token that a page must know before it is told anything."""

    def __init__(self) -> None:
        self.text = secrets.token_urlsafe(32)

    def fits(self, candidate: str) -> bool:
        """Tells whether a text is the token; the time does not depend on the differing letter."""
        return hmac.compare_digest(self.text.encode(), candidate.encode("utf-8", "replace"))


@dataclass(frozen=True)
class Served:
    """Where the application is served."""

    host: str
    port: int
    bound: str

    @property
    def authority(self) -> str:
        """Host and port as an address has them, one that a browser here can open."""
        host = self.host
        if self._is_any:
            host = "::1" if ":" in self.bound else "127.0.0.1"
        return f"[{host}]:{self.port}" if ":" in host else f"{host}:{self.port}"

    def answers_to(self, authority: str) -> bool:
        """Tells whether a Host header names this server.

        A name that someone else's name server may lead here (DNS rebinding) does not. Where it
        is bound to all addresses, every address does, for none is asked of a name server.
        """
        name, _, port = authority.rpartition(":")
        if not name or not port.isascii() or not port.isdigit() or int(port[:6]) != self.port:
            return False
        name = name.removeprefix("[").removesuffix("]").lower()
        if name in (self.host.lower(), self.bound):
            return True
        if name == "localhost":
            return self._is_any or ipaddress.ip_address(self.bound).is_loopback
        return self._is_any and (_is_address(name) or name == socket.gethostname().lower())

    @property
    def _is_any(self) -> bool:
        return ipaddress.ip_address(self.bound).is_unspecified


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


class Guard:
    """Guard of the server: lets requests for it pass, and sockets of its own page."""

    def __init__(self, app: ASGIApp, served: Served) -> None:
        self._app = app
        self._served = served

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answers, or has the application answer."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refused = self._refused(scope)
        if refused is None:
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await _deny(refused, scope, receive, send)
        else:
            await refused(scope, receive, _with_headers(send))

    def _refused(self, scope: Scope) -> PlainTextResponse | None:
        headers = Headers(scope=scope)
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        if len(hosts) != 1 or not self._served.answers_to(hosts[0]):
            return PlainTextResponse("this server has another name\n", 421)
        if scope["type"] == "websocket":
            if origins != [f"http://{hosts[0]}"]:
                return PlainTextResponse("sockets are for the page of this server\n", 403)
        elif scope["method"] not in _METHODS:
            return PlainTextResponse("nothing is sent here\n", 405)
        return None


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] in ("http.response.start", "websocket.http.response.start"):
            headers = MutableHeaders(scope=message)
            for name, value in HEADERS.items():
                headers[name] = value
        await send(message)

    return sending


async def _deny(response: PlainTextResponse, scope: Scope, receive: Receive, send: Send) -> None:
    """Refuses a socket with an answer of HTTP, where the server can; else closes it."""
    if "websocket.http.response" in scope.get("extensions", {}):
        await response(scope, receive, _with_headers(send))
    else:
        await send({"type": "websocket.close", "code": _POLICY_VIOLATION, "reason": ""})
