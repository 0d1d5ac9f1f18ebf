"""Video of an address that a component tells: from a real server of HTTP, through a real studio."""

from __future__ import annotations

import asyncio
import http.client
import json
import time
from contextlib import ExitStack, closing, contextmanager
from typing import TYPE_CHECKING, Any

import pytest
from camera_server import MIXED, png, register, serving_camera
from simulated_vehicle import until
from studio_client import RefusedError
from websockets.exceptions import ConnectionClosed

from jausml import Component
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.operating import streams
from jausml.authoring.studio.operating.streams import Stream, connection_to
from jausml.authoring.studio.security import HEADERS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from camera_server import CameraServer
    from studio_client import Page, Server

CAMERA = "100.1.20"
OF = {"component": CAMERA, "report": "ReportDigitalResourceEndpoint"}
PROVIDED = ("StillImage", "DigitalResourceDiscovery")
PATHS = ("/mjpeg", "/mjpeg?2", "/mjpeg?3", "/one", "/page", "/drawing", "/moved", "/missing")


@pytest.fixture(scope="module")
def camera() -> Iterator[CameraServer]:
    with serving_camera() as camera:
        yield camera


@pytest.fixture(scope="module")
def told(operated: Server, port: int, camera: CameraServer) -> Iterator[Page]:
    """A page that watches what a camera tells, for all tests: they leave nothing behind."""
    urls = [*map(camera.url, PATHS), "file:///etc/passwd", f"http://{'x' * 120}/"]
    with (
        Component(CAMERA, provides=PROVIDED, port=port),
        Component(name="registrar", port=port) as registrar,
        operated.page("/operate") as page,
    ):
        register(registrar, CAMERA, urls)
        until(lambda: is_watched(page))
        until(lambda: set(urls) <= set(values(page)["urls"]))
        yield page
        page.ask("unwatch", **OF)


def is_watched(page: Page, of: dict[str, str] = OF) -> bool:
    try:
        page.ask("watch", rate=5, **of)
    except RefusedError:
        return False
    return True


def values(page: Page, component: str = CAMERA) -> Any:
    found = {each["component"]: each for each in page.ask("values")["values"]}
    return found[component]


def begin(page: Page, camera: CameraServer, path: str, **other: str) -> Any:
    return page.ask("stream", **{**OF, "url": camera.url(path), "host": camera.host, **other})


@contextmanager
def got(server: Server, ticket: str, dest: str = "image") -> Iterator[http.client.HTTPResponse]:
    connection = http.client.HTTPConnection(server.host, server.port, timeout=20)
    connection.request("GET", f"/stream/{ticket}", headers={"Sec-Fetch-Dest": dest})
    with closing(connection), connection.getresponse() as response:
        yield response


def status_of(server: Server, ticket: str, dest: str = "image") -> int:
    with got(server, ticket, dest) as response:
        return response.status


@pytest.mark.ports
@pytest.mark.live
def test_pictures_come_until_the_page_hides_them(
    operated: Server, told: Page, camera: CameraServer
) -> None:
    before = len(camera.asked)
    found = begin(told, camera, "/mjpeg")
    assert found["is_video"] is False
    assert camera.asked[before:] == ["/mjpeg"]
    with got(operated, found["stream"]) as response:
        assert response.getheader("Content-Type") == MIXED
        assert response.getheader("Cache-Control") == "no-store"
        assert [response.getheader(name) for name in HEADERS] == list(HEADERS.values())
        assert png(120) in response.read(4 * len(png(120)))
        assert status_of(operated, found["stream"]) == 404  # a ticket is for once
        told.ask("unstream", stream=found["stream"])
        until(lambda: camera.looking == 0)


@pytest.mark.ports
@pytest.mark.live
def test_a_picture_alone_ends_by_itself(operated: Server, told: Page, camera: CameraServer) -> None:
    with got(operated, begin(told, camera, "/one")["stream"]) as response:
        assert response.read() == png(40)


@pytest.mark.ports
@pytest.mark.live
def test_a_stream_ends_with_who_reads_it(
    operated: Server, told: Page, camera: CameraServer
) -> None:
    with got(operated, begin(told, camera, "/mjpeg")["stream"]) as response:
        response.read(100)
    until(lambda: camera.looking == 0)
    with operated.page("/operate") as other:
        ticket = begin(other, camera, "/mjpeg")["stream"]
        until(lambda: camera.looking == 1)
    until(lambda: camera.looking == 0)  # its page is gone
    assert status_of(operated, ticket) == 404


@pytest.mark.ports
@pytest.mark.live
@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("/page", "text/html, neither picture nor video"),
        ("/drawing", r"image/svg\+xml, neither"),
        ("/moved", "302: nothing is followed"),
        ("/missing", "answers 404"),
        ("/elsewhere", "does not tell this address"),
    ],
)
def test_nothing_else_is_passed_on(told: Page, camera: CameraServer, path: str, why: str) -> None:
    before = len(camera.asked)
    with pytest.raises(RefusedError, match=why):
        begin(told, camera, path)
    assert camera.asked[before:] == ([] if path == "/elsewhere" else [path])


@pytest.mark.ports
@pytest.mark.live
def test_other_protocols_and_other_hosts_than_shown_are_refused(
    told: Page, camera: CameraServer
) -> None:
    before = list(camera.asked)
    with pytest.raises(RefusedError, match="neither http nor https"):
        told.ask("stream", **OF, url="file:///etc/passwd", host="")
    with pytest.raises(RefusedError, match="not the one that was shown"):
        begin(told, camera, "/mjpeg", host="camera.example")
    assert camera.asked == before


@pytest.mark.ports
@pytest.mark.live
def test_a_third_stream_is_refused_until_one_is_hidden(
    operated: Server, told: Page, camera: CameraServer
) -> None:
    tickets = [begin(told, camera, path)["stream"] for path in ("/mjpeg", "/mjpeg?2")]
    with pytest.raises(RefusedError, match="2 streams are shown"):
        begin(told, camera, "/mjpeg?3")
    told.ask("unstream", stream=tickets[0])
    tickets.append(begin(told, camera, "/mjpeg?3")["stream"])
    for each in tickets:
        told.ask("unstream", stream=each)
    until(lambda: camera.looking == 0)
    assert status_of(operated, tickets[1]) == 404


@pytest.mark.ports
@pytest.mark.live
def test_only_a_picture_of_a_page_that_may_look_gets_it(
    operated: Server, told: Page, camera: CameraServer
) -> None:
    """Without the token nobody has a ticket; what is no picture in a page gets nothing."""
    with operated.connect("/operate") as stranger:
        asked = {"jsonrpc": "2.0", "id": 0, "method": "stream", "params": {}}
        stranger.send(json.dumps(asked))
        with pytest.raises(ConnectionClosed):
            stranger.recv(20)
    ticket = begin(told, camera, "/mjpeg")["stream"]
    assert status_of(operated, ticket, dest="document") == 404
    assert status_of(operated, "guessed") == 404
    told.ask("unstream", stream=ticket)


@pytest.mark.ports
@pytest.mark.live
def test_an_address_that_is_told_no_more_ends(
    operated: Server, told: Page, camera: CameraServer
) -> None:
    with operated.page("/operate") as other:
        ticket = begin(other, camera, "/mjpeg")["stream"]
        with got(operated, ticket) as response:
            told.ask("unwatch", **OF)
            while response.read(1000):
                pass
        with pytest.raises(RefusedError, match="does not tell"):
            begin(other, camera, "/mjpeg")
    until(lambda: is_watched(told) and values(told)["urls"])
    until(lambda: camera.looking == 0)


@pytest.mark.slow
@pytest.mark.ports
@pytest.mark.live
def test_an_address_of_a_component_that_is_gone_ends(
    operated: Server, port: int, camera: CameraServer
) -> None:
    of = {**OF, "component": "100.1.21"}
    with operated.page("/operate") as page, ExitStack() as stack:
        component = Component(of["component"], provides=PROVIDED, port=port)
        stack.enter_context(component)
        with Component(name="registrar", port=port) as registrar:
            register(registrar, of["component"], [camera.url("/mjpeg")])
        until(lambda: is_watched(page, of))
        until(lambda: values(page, of["component"])["urls"])
        until(lambda: is_known(page, of["component"]))
        with got(operated, begin(page, camera, "/mjpeg", **of)["stream"]) as response:
            stack.close()
            while response.read(1000):
                pass


def is_known(page: Page, component: str) -> bool:
    components = page.ask("hello")["state"]["components"]
    return any(each["id"] == component and each["level"] == "ok" for each in components)


@pytest.mark.parametrize(
    ("url", "shown"),
    [
        ("http://h\\@i/", "h"),
        ("http://i@h/", "h"),
        ("http://h:99999/", "h:99999"),
        ("http://h:x/", "h:x"),
        ("http://h/ä", "h"),
        ("http://h/a b", "h"),
        ("http://h/\r\nX: y", "h"),
        ("http:///path", ""),
        ("//h/path", "h"),
        ("http://[::1/", "[::1"),
    ],
)
def test_what_is_no_plain_address_is_refused(url: str, shown: str) -> None:
    with pytest.raises(AnswerError):
        connection_to(url, shown)


def test_the_host_is_the_one_that_browsers_show() -> None:
    for url, shown, port in (
        ("http://H:80/front?a=1#b", "h", 80),
        ("http://[::1]:8080", "[::1]:8080", 8080),
        ("https://h/", "h", 443),
    ):
        connection, path = connection_to(url, shown)
        assert connection.port == port
        assert path == ("/front?a=1" if "?" in url else "/")


def test_a_stream_is_held_back_to_its_bytes_each_second(
    camera: CameraServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits: list[float] = []

    async def note(seconds: float) -> None:
        waits.append(seconds)

    async def read(stream: Stream) -> int:
        monkeypatch.setattr(asyncio, "sleep", note)
        count = 0
        async for piece in stream.pieces():
            if len(waits) == 5:
                return count  # what the five waits are for
            count += len(piece)
        return 0

    monkeypatch.setattr(streams, "MOST_EACH_SECOND", 1)
    stream = Stream(1, camera.url("/mjpeg"), camera.host, lambda: True)
    begin = time.monotonic()
    count = asyncio.run(read(stream))
    passed = time.monotonic() - begin
    stream.close()
    assert waits == sorted(waits)
    assert count - passed <= waits[-1] <= count  # seconds, of one byte each
