"""The process of `jausml studio`: how it begins and ends."""

import signal
import socket
from pathlib import Path

import pytest
from studio_client import LONGEST, begun, serving, started
from sweeps import sweep

pytestmark = pytest.mark.ports


def ended(path: Path, page: Path, *options: str) -> tuple[int, str]:
    process = begun(path, page, *options)
    _, errors = process.communicate(timeout=LONGEST)
    return process.returncode, errors


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_while_pages_are_open(server, sent):
    with server.page() as page:
        page.send("view", file="catvehicle.xmi", view="system")
        server.process.send_signal(sent)
        assert server.process.wait(LONGEST) == 0


def test_a_signal_ends_it_as_soon_as_the_address_is_told(folder, built):
    process = started(folder, built)
    assert process.stdout is not None
    assert process.stdout.readline().startswith("jausml studio: http://127.0.0.1:")
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=LONGEST)
    assert (process.returncode, errors) == (0, "Ctrl-C ends it.\n")


def test_without_the_page_it_says_how_to_build_it(folder, tmp_path):
    code, errors = ended(folder, tmp_path / "nothing")
    assert code == 2
    assert errors.startswith("Error: the page is missing: run `make studio` in")
    assert "`make wheel`" in errors


@pytest.mark.slow
def test_a_port_that_is_taken_is_told(folder, built):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        code, errors = ended(folder, built, "--port", port)
    assert code == 2
    assert errors.startswith(f"Error: cannot serve at 127.0.0.1 port {port}: ")


@pytest.mark.parametrize(
    "host", sweep(["256.1.1.1", "nowhere.invalid", "", "\u00fc" * 70], every=4)
)
def test_a_host_that_is_none_is_told(folder, built, host):
    code, errors = ended(folder, built, "--host", host)
    assert code == 2
    assert errors.startswith("Error: cannot serve at ")


@pytest.mark.slow
def test_a_path_that_is_not_there_is_told(folder, built):
    code, errors = ended(folder / "nothing.xmi", built)
    assert code == 2
    assert "No such file or directory" in errors


def test_its_port_can_be_chosen(folder, built):
    with serving(folder, built) as before:
        port = before.port
    with serving(folder, built, "--port", str(port)) as server:
        assert server.port == port


@pytest.mark.slow
def test_nothing_of_what_is_asked_is_logged(folder, built):
    process = started(folder, built)
    assert process.stdout is not None
    host = process.stdout.readline().split("/")[2]
    name, _, port = host.partition(":")
    with socket.create_connection((name, int(port))) as client:
        client.sendall(f"GET /?token=secret HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        assert client.recv(100).startswith(b"HTTP/1.1 200")
        client.sendall(b"\x00nonsense secret\r\n\r\n")
        while client.recv(4096):
            pass
    process.terminate()
    out, errors = process.communicate(timeout=LONGEST)
    assert process.returncode == 0
    assert "secret" not in out + errors
