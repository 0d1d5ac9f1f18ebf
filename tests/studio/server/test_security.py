"""Who is answered: hosts, origins, tokens and files, asked over real sockets."""

import http.client
import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from studio_client import RefusedError, Server, serving
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from jausml.live.serving.security import HEADERS, Served
from jausml.live.serving.server import MOST_SOCKETS
from jausml.live.serving.sockets import LARGEST_MESSAGE

pytestmark = pytest.mark.ports

REFUSED, UNAUTHORIZED = -32000, -32001


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, built: Path) -> Iterator[Server]:
    """One for all: none of these tests changes a file."""
    with serving(tmp_path_factory.mktemp("project"), built) as server:
        yield server


def get(server: Server, path: str, method: str = "GET", **headers: str) -> Any:
    connection = http.client.HTTPConnection(server.host, server.port, timeout=20)
    connection.putrequest(method, path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    response = connection.getresponse()
    response.body = response.read()  # type: ignore[attr-defined]
    connection.close()
    return response


def all_results(client: ClientConnection) -> None:
    while True:
        assert "result" not in json.loads(client.recv(20))


@pytest.mark.parametrize("path", ["/", "/assets/page.js", "/missing", "/socket"])
def test_each_answer_has_the_headers(server, path):
    response = get(server, path)
    for name, value in HEADERS.items():
        assert response.getheader(name) == value
    assert response.getheader("Server") is None


def test_the_page_is_served(server):
    assert b"<title>page</title>" in get(server, "/").body
    assert get(server, "/assets/page.js").status == 200
    assert get(server, "/missing").status == 404


@pytest.mark.parametrize(
    "host",
    ["attacker.example", "127.0.0.1", "127.0.0.1:1", "localhost.attacker.example:{port}", ""],
)
def test_another_host_is_refused(server, host):
    response = get(server, "/", Host=host.format(port=server.port))
    assert response.status in (400, 421)
    assert b"<title>" not in response.body


def test_localhost_is_this_server(server):
    assert get(server, "/", Host=f"localhost:{server.port}").status == 200


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_nothing_is_sent_by_http(server, method):
    assert get(server, "/", method).status == 405


@pytest.mark.parametrize("path", ["/socket", "/language"])
@pytest.mark.parametrize("origin", [None, "null", "http://attacker.example", "http://localhost:1"])
def test_a_socket_of_another_page_is_refused(server, path, origin):
    with pytest.raises(InvalidStatus) as refused, server.connect(path, origin=origin):
        pass
    assert refused.value.response.status_code == 403
    assert refused.value.response.headers["X-Frame-Options"] == "DENY"


@pytest.mark.parametrize("path", ["/socket", "/language"])
@pytest.mark.parametrize(
    "first",
    [
        '{"jsonrpc":"2.0","id":0,"method":"hello","params":{"token":"wrong"}}',
        '{"jsonrpc":"2.0","id":0,"method":"hello","params":{"token":""}}',
        '{"jsonrpc":"2.0","id":0,"method":"hello","params":{"token":"ü"}}',
        '{"jsonrpc":"2.0","id":0,"method":"hello","params":{}}',
        '{"jsonrpc":"2.0","id":0,"method":"problems","params":{"file":"catvehicle.xmi"}}',
        "[]",
        "{",
        b"\xff",
    ],
)
def test_without_the_token_a_socket_is_closed(server, path, first):
    with server.connect(path) as client:
        client.send(first)
        with pytest.raises(ConnectionClosed) as closed:
            all_results(client)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008


def test_the_token_does_for_hello_alone(server):
    with server.connect() as client:
        asked = {"jsonrpc": "2.0", "id": 0, "method": "log", "params": {"token": server.token}}
        client.send(json.dumps(asked))
        assert json.loads(client.recv(20))["error"]["code"] == UNAUTHORIZED


def test_a_message_that_is_too_long_closes_its_socket(server):
    with server.page() as page, pytest.raises(ConnectionClosed):
        page.ask("write", file="x.ros2jaus", text="x" * LARGEST_MESSAGE, base=0)


def test_sockets_are_counted(server):
    with ExitStack() as held:
        for _ in range(MOST_SOCKETS):
            held.enter_context(server.connect())
        one_more = held.enter_context(server.connect())
        with pytest.raises(ConnectionClosed) as closed:
            one_more.recv(20)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1013


ELSEWHERE = ("../secret.xmi", "/etc/passwd", "link.xmi", "..", "", "\0", "x" * 5000, "catvehicle")


def test_files_elsewhere_are_no_files(folder, built):
    (folder.parent / "secret.xmi").write_text("<secret/>", encoding="utf-8")
    (folder / "link.xmi").symlink_to(folder.parent / "secret.xmi")
    with serving(folder, built) as server, server.page() as page:
        assert [entry["path"] for entry in page.project["files"]] == ["catvehicle.xmi"]
        for file, method in product(ELSEWHERE, ("problems", "views", "create")):
            create = {"kind": "create", "file": file, "type": "system.System", "values": {}}
            asked = (
                {"commands": [create], "label": "create"} if method == "create" else {"file": file}
            )
            with pytest.raises(RefusedError) as refused:
                page.ask("edit" if method == "create" else method, **asked)
            assert refused.value.code == REFUSED, (file, method)
    assert (folder.parent / "secret.xmi").read_text(encoding="utf-8") == "<secret/>"


def test_the_page_has_nothing_outside_of_its_folder(server):
    for path in ("/../catvehicle.xmi", "/%2e%2e/catvehicle.xmi", "/assets/..%2f..%2f/etc/passwd"):
        assert get(server, path).status == 404


def test_the_port_is_open_to_this_computer_alone(server):
    assert server.host == "127.0.0.1"
    with socket.socket() as other:
        other.settimeout(5)
        with pytest.raises(OSError, match="refused"):
            other.connect(("127.0.0.2", server.port))


def test_a_server_for_all_addresses_answers_to_addresses_and_to_no_name(folder, built):
    with serving(folder, built, "--host", "0.0.0.0") as server:  # noqa: S104
        assert server.host == "127.0.0.1"
        assert get(server, "/", Host=f"127.0.0.1:{server.port}").status == 200
        assert get(server, "/", Host=f"192.0.2.7:{server.port}").status == 200
        assert get(server, "/", Host=f"attacker.example:{server.port}").status == 421


@pytest.mark.parametrize(
    ("host", "bound", "authority"),
    [
        ("127.0.0.1", "127.0.0.1", "127.0.0.1:80"),
        ("::1", "::1", "[::1]:80"),
        ("::", "::", "[::1]:80"),
        ("0", "0.0.0.0", "127.0.0.1:80"),  # noqa: S104
        ("robot.example", "192.0.2.7", "robot.example:80"),
    ],
)
def test_the_authority_is_one_that_is_answered_to(host, bound, authority):
    served = Served(host, 80, bound)
    assert served.authority == authority
    assert served.answers_to(authority)
