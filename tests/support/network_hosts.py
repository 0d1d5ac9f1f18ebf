"""Two hosts on one wire: network namespaces, joined by a pair of virtual interfaces."""

import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

_HOLDER = "ip link set lo up && ip link set lo multicast on && echo ready && exec cat"


class NetworkHost:
    """A network namespace, for as long as the process lives that holds it.

    Args:
        address: IPv4 address of its interface `wire`.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        self._holder = subprocess.Popen(
            ["unshare", "--net", "sh", "-c", _HOLDER],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert self._holder.stdout is not None
        if self._holder.stdout.readline() != b"ready\n":
            raise OSError(self.close() or "no network namespace")

    @property
    def number(self) -> int:
        """Processes that holds the namespace."""
        return self._holder.pid

    def command(self, line: Sequence[str]) -> list[str]:
        """Returns a command line that runs on this host."""
        return ["nsenter", f"--net=/proc/{self.number}/ns/net", "--", *line]

    def run(self, *line: str) -> str:
        """Runs a command on this host; returns what it wrote.

        Raises:
            OSError: It failed.
        """
        done = subprocess.run(self.command(line), capture_output=True, text=True, timeout=60)
        if done.returncode != 0:
            raise OSError(done.stderr.strip())
        return done.stdout

    def close(self) -> str:
        """Ends the host; returns what its holder complained of."""
        return self._holder.communicate(timeout=60)[1].decode().strip()


def _await_wire(host: NetworkHost) -> None:
    """Waits until the interface runs: DDS never looks again at one that does not yet."""
    end = time.monotonic() + 30
    while "LOWER_UP" not in host.run("ip", "-br", "link", "show", "up", "dev", "wire"):
        if time.monotonic() > end:
            raise OSError("the interface of a host does not run")
        time.sleep(0.01)


@contextmanager
def two_hosts(first: str, second: str) -> Iterator[tuple[NetworkHost, NetworkHost]]:
    """Makes two hosts with these addresses in a network of 24 bits.

    Raises:
        OSError: Namespaces are refused here.
    """
    hosts: list[NetworkHost] = []
    try:
        hosts += [NetworkHost(first)]
        hosts += [NetworkHost(second)]
        there = ["peer", "name", "wire", "netns", str(hosts[1].number)]
        hosts[0].run("ip", "link", "add", "wire", "type", "veth", *there)
        for host in hosts:
            host.run("ip", "address", "add", f"{host.address}/24", "dev", "wire")
            host.run("ip", "link", "set", "wire", "up")
        for host in hosts:
            _await_wire(host)
        yield hosts[0], hosts[1]
    finally:
        for host in hosts:
            host.close()
