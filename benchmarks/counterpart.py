"""The other end of a run under load, in a process of its own: it sends and takes as it is told.

It reads one JSON object a line and answers each with one, in which stand the messages `sent` and
`taken`, and the datagrams `sunk` at the sink:

    {"do": "publish", "topic": T, "rate": R, "seconds": S}   tells what it sent, and took meanwhile
    {"do": "send", "rate": R, "seconds": S, "which": N}      the same with the Nth shared socket
    {"do": "take", "seconds": S}                             takes what comes, until nothing comes
    {"do": "greet", "address": [1, 1, 10]}                   tells a bridge where the sink is
    {"do": "end"}
"""

from __future__ import annotations

import argparse
import json
import socket
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ends import PEER, QUERY_STATUS, SINK, JausEnd, RosEnd, drained, message_class, paced

if TYPE_CHECKING:
    from processes import Child, Children
    from samples import Sample

HERE = Path(__file__).resolve().parent


class Counterpart:
    """The process, as the one that tells it sees it."""

    def __init__(
        self, children: Children, folder: Path, sample: Sample, *options: str, shared: Any = ()
    ) -> None:
        """Starts it.

        Args:
            children: Who starts processes.
            folder: Where files may be written.
            sample: The message that it sends and takes.
            options: Its further command line.
            shared: Sockets that it shares.
        """
        for name, data in (("ros", sample.ros), ("jaus", sample.jaus)):
            (folder / f"counterpart.{name}").write_bytes(data)
        line = [HERE / "counterpart.py", folder / "counterpart", "--type", sample.type, *options]
        descriptors = [each.fileno() for each in shared]
        self._child: Child = children.start(*line, descriptors=descriptors)
        self.answer()

    def begin(self, what: str, **arguments: Any) -> None:
        """Tells it to do something."""
        assert self._child.process.stdin is not None
        print(json.dumps({"do": what, **arguments}), file=self._child.process.stdin, flush=True)

    def ask(self, what: str, **arguments: Any) -> dict[str, int]:
        """Tells it to do something, and waits for the answer."""
        self.begin(what, **arguments)
        return self.answer()

    def answer(self) -> dict[str, int]:
        """Waits for the answer to what it was told.

        Raises:
            RuntimeError: It has ended.
        """
        assert self._child.process.stdout is not None
        line = self._child.process.stdout.readline()
        if not line:
            raise RuntimeError("the counterpart has ended")
        found: dict[str, int] = json.loads(line)
        return found


class _Ends:
    """The ends in the process itself."""

    def __init__(self, options: argparse.Namespace) -> None:
        ros = RosEnd("counterpart")
        ros_class = message_class(options.type)
        self._serialized = options.file.with_suffix(".ros").read_bytes()
        encoded = options.file.with_suffix(".jaus").read_bytes()
        self._publishers = {each: ros.publisher(ros_class, each) for each in options.publish}
        self._taken = [ros.subscription(ros_class, each) for each in options.take]
        # What a bridge sends to the sink comes here, and is thrown away.
        self._sinks = [JausEnd(SINK, port) for port in options.sink]
        self._sunk = 0
        self._senders = []
        for each in options.shared:
            descriptor, port, *address = map(int, each.split(":"))
            end = JausEnd(PEER, port, socket.socket(fileno=descriptor))
            parts = end.outgoing(encoded, (address[0], address[1], address[2]))
            self._senders.append(partial(end.send, parts))

    def publish(self, topic: str, rate: float, seconds: float) -> dict[str, int]:
        publish = partial(self._publishers[topic].publish, self._serialized)
        sent, taken = paced(publish, self._drain, rate, seconds)
        return self._answer(sent, taken)

    def send(self, which: int, rate: float, seconds: float) -> dict[str, int]:
        sent, taken = paced(self._senders[which], self._drain, rate, seconds)
        return self._answer(sent, taken)

    def take(self, seconds: float) -> dict[str, int]:
        return self._answer(0, drained(self._drain, seconds))

    def greet(self, address: list[int]) -> dict[str, int]:
        """Sends a query of the sink, which tells a bridge where that is."""
        for each in self._sinks:
            destination = (address[0], address[1], address[2])
            each.send(each.outgoing(QUERY_STATUS, destination))
        return self._answer(0, 0)

    def _answer(self, sent: int, taken: int) -> dict[str, int]:
        sunk, self._sunk = self._sunk, 0
        return {"sent": sent, "taken": taken, "sunk": sunk}

    def _drain(self) -> int:
        self._sunk += sum(each.discard() for each in self._sinks)
        return sum(each.discard() for each in self._taken)


def main() -> None:
    """Answers until it is told to end, or nobody is there to tell."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--type", required=True)
    parser.add_argument("--publish", nargs="*", default=[])
    parser.add_argument("--take", nargs="*", default=[])
    parser.add_argument("--sink", nargs="*", default=[], type=int)
    parser.add_argument("--shared", nargs="*", default=[], help="descriptor:port:address")
    ends = _Ends(parser.parse_args())
    _answer({})
    while line := sys.stdin.readline():
        order = json.loads(line)
        what = order.pop("do")
        if what == "end":
            break
        _answer(getattr(ends, what)(**order))


def _answer(found: dict[str, int]) -> None:
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
