"""Recorder of both sides of a running system into MCAP files, each with a capture beside it."""

from __future__ import annotations

import os
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Lock, Thread
from typing import Any, BinaryIO, cast

from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import bridge, ros, system
from jausml.language.model import Model
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.live.messages import Catalogue
from jausml.live.recording.captured import CapturedMessages, JausWriter
from jausml.live.recording.mcap_files import McapFile, TrafficFilter, need_library
from jausml.live.recording.mcap_records import END
from jausml.live.recording.ros_definitions import installed_definition, modelled_definition
from jausml.live.traffic.captures import CapturedFrame
from jausml.live.traffic.frames import Datagram, PcapWriter

CAPTURE = ".pcap"  # ending of the capture beside an MCAP file

_MOST_DIGITS = 4  # of the number of a file in a row; a date has more


@dataclass(frozen=True)
class SplitLimits:
    """Limits after which a recording continues in new files; None for no limit.

    Attributes:
        size: Bytes of a pair of files.
        duration: Seconds of a pair of files.
        files: Number of pairs of files that are kept, the latest ones.
    """

    size: int | None = None
    duration: float | None = None
    files: int | None = None

    @property
    def splits(self) -> bool:
        """Whether the files of a recording are numbered."""
        return self.size is not None or self.duration is not None


class FilePair:
    """An MCAP file and the capture beside it, both open for writing."""

    def __init__(self, path: Path, compression: str, *, overwrites: bool) -> None:
        """Creates both files (`OSError`: one exists, unless `overwrites`, or cannot be written)."""
        mode = "wb" if overwrites else "xb"
        self.path, self.begun = path, time.monotonic()
        self._paths = (path, path.with_suffix(CAPTURE))
        self._is_complete = False
        with ExitStack() as new, ExitStack() as stack:
            self._streams = []
            for file in self._paths:
                self._streams.append(cast("BinaryIO", stack.enter_context(file.open(mode))))
                if not overwrites:
                    new.callback(file.unlink)  # one alone would make a pair of a file of others
            self.file = McapFile(self._streams[0], has_jaus=True, compression=compression)
            self.capture = PcapWriter(self._streams[1])
            self.flush()
            self._written = stack.pop_all()
            new.pop_all()

    @property
    def size(self) -> int:
        """Bytes of both files that were passed to the system."""
        return sum(self._whole)

    def flush(self) -> None:
        """Passes the written bytes to the system, in whole records."""
        self.file.flush()
        self._streams[1].flush()
        self._whole = [stream.tell() for stream in self._streams]

    def sync(self) -> None:
        """Waits until the disk has the bytes that were passed to the system."""
        for stream in self._streams:
            os.fsync(stream.fileno())

    def close(self) -> None:
        """Ends both files, and waits until they are on the disk."""
        with self._written:
            self.file.close()
            for stream in self._streams:
                stream.flush()
            self.sync()
        self._is_complete = True

    def give_up(self) -> None:
        """Closes both files after an error of the disk, and cuts them to their last whole state."""
        if self._is_complete:
            return
        with suppress(OSError):
            self._written.close()
        for path, size, end in zip(self._paths, self._whole, (END, b""), strict=True):
            with suppress(OSError):
                os.truncate(path, size + len(end))  # it needs no new blocks of a full disk
                with path.open("r+b") as stream:
                    stream.seek(size)
                    stream.write(end)


class RecordingFiles:
    """The pairs of files of a recording.

    Attributes:
        paths: The MCAP files so far.
        current: The pair that is written now.
    """

    def __init__(
        self,
        path: Path,
        limits: SplitLimits,
        compression: str = "zstd",
        *,
        overwrites: bool = False,
    ) -> None:
        """Creates the first pair.

        Args:
            path: The MCAP file. With limits, files have a number before the ending, which continues
                the numbers of existing files.
        """
        need_library()
        self._path, self._limits, self._compression = path, limits, compression
        self.paths: list[Path] = []
        self._next = 1 + max((number for number, _ in self._row()), default=-1)
        self.current = self._further() if limits.splits else self._part(path, overwrites=overwrites)
        self._forget()

    def turn(self) -> bool:
        """Begins a new pair if a limit is reached; returns whether it did."""
        limits, current = self._limits, self.current
        is_full = limits.size is not None and current.size >= limits.size
        is_over = limits.duration is not None
        is_over = is_over and time.monotonic() - current.begun >= (limits.duration or 0.0)
        if not (is_full or is_over):
            return False
        self.current.close()
        self.current = self._further()
        self._forget()
        return True

    def _further(self) -> FilePair:
        """Begins the next pair; skips numbers that another recorder took meanwhile."""
        while True:
            path = self._path.with_stem(f"{self._path.stem}_{self._next}")
            self._next += 1
            try:
                return self._part(path, overwrites=False)
            except FileExistsError:
                continue

    def _part(self, path: Path, *, overwrites: bool) -> FilePair:
        part = FilePair(path, self._compression, overwrites=overwrites)
        self.paths.append(path)
        return part

    def _forget(self) -> None:
        """Removes the oldest pairs beyond the limit."""
        if self._limits.files is None:
            return
        for _, path in sorted(self._row())[: -self._limits.files]:
            for file in (path, path.with_suffix(CAPTURE)):
                file.unlink(missing_ok=True)
            self.paths = [file for file in self.paths if file != path]

    def _row(self) -> list[tuple[int, Path]]:
        """Returns the existing numbered MCAP files with their numbers.

        Other files, such as those with a date, do not count, so that they are not removed.
        """
        stem, suffix = re.escape(self._path.stem), re.escape(self._path.suffix)
        form = re.compile(rf"{stem}_(0|[1-9][0-9]*){suffix}")
        matches = ((form.fullmatch(file.name), file) for file in self._path.parent.iterdir())
        return [
            (int(match[1]), file)
            for match, file in matches
            if match and (len(match[1]) <= _MOST_DIGITS or file in self.paths)
        ]


# The ending of the topic of the calls of a service, where it is introspected.
CALLS = "/_service_event"

# Where bridges tell how they are, with the accounts of connections and peers.
DIAGNOSTICS = "/diagnostics"

# The ending of the topic of the goals of an action, where it is introspected.
GOALS = f"/_action/send_goal{CALLS}"

RESULTS = f"/_action/get_result{CALLS}"  # the same of its results

# What follows the name of an action in the topics on which others see what it does; the last ones
# where it is introspected.
ACTION_TOPICS = (
    "/_action/feedback",
    "/_action/status",
    GOALS,
    RESULTS,
    f"/_action/cancel_goal{CALLS}",
)


def topics_of(model: Model) -> dict[str, ros.MessageType | None]:
    """Returns the topics of a model with their types.

    Included are the topics of services and actions, and the diagnostics of bridges. The model does
    not have their types (None), which must be installed.
    """
    types_by_topic: dict[str, ros.MessageType | None] = {}
    for whole in model.instances(system.System, library=False):
        for end in endpoints([*whole.bridges, *whole.nodes]):
            types_by_topic[end.topic] = end.type
        for owner in whole.bridges:
            types_by_topic.update((topic, None) for topic in (DIAGNOSTICS, *_seen_calls(owner)))
    return types_by_topic


def _seen_calls(owner: bridge.Bridge) -> Iterator[str]:
    """Yields the topics of introspected services and actions of a bridge."""
    for call in owner.serviceConnections:
        if call.service is not None:
            yield _full(owner, call.service) + CALLS
    for action in owner.actionConnections:
        if action.action is not None:
            yield from (_full(owner, action.action) + topic for topic in ACTION_TOPICS)


def _full(owner: bridge.Bridge, name: str) -> str:
    return resolve_topic(name, owner.namespace or "", owner.name or "")


class Recorder:
    """Takes messages of both sides on their threads; a third thread writes them to the disk.

    Attributes:
        fault: Why files can no longer be written; None while they can.
        reached: Time in seconds since 1970 up to which the disk has all messages; None for none.
    """

    def __init__(
        self,
        parts: RecordingFiles,
        catalogue: Catalogue,
        types: Mapping[str, ros.MessageType | None],
        selection: TrafficFilter,
        offers: Mapping[str, Mapping[str, str]] | None = None,
    ) -> None:
        """Begins without a message.

        Args:
            types: Types of topics in the model, for those that are not installed.
            offers: Metadata of rosbag2 on publishers by topic, which may grow.
        """
        self.captured = CapturedMessages()
        self.topics: Counter[str] = Counter()
        self.jaus = JausWriter(catalogue)
        self.undefined: set[str] = set()
        self.fault: OSError | None = None
        self.reached: float | None = None
        self._parts = parts
        self._selection = selection
        self._types = types
        self._offers = {} if offers is None else offers
        self._installation = Installation()
        self._known: dict[tuple[str, str], str] = {}
        self._lock = Lock()
        # Numbers of frames and messages: all, those that were flushed, and those on the disk.
        self._taken = self._flushed = self._kept = 0

    @property
    def lost(self) -> int:
        """Number of frames and messages after `reached`, once files can no longer be written."""
        return self._taken - self._kept

    @contextmanager
    def kept(self, period: float, begun: Callable[[], None]) -> Iterator[None]:
        """Writes to the disk once in `period` seconds, and ends the files after the block.

        `begun` is called after each begin of new files.
        """
        ended = Event()
        keeper = Thread(target=self._keep, args=(period, ended, begun), daemon=True)
        keeper.start()
        try:
            yield
        finally:
            ended.set()
            keeper.join()
            self._write(0, self._parts.current.close)
            if self.fault is not None:
                self._parts.current.give_up()

    def take_frame(self, frame: CapturedFrame, datagram: Datagram | None) -> None:
        """Writes a frame, and its messages.

        Args:
            datagram: The datagram that the frame completes; None for a part of one.
        """
        if datagram is not None and not self._selection.wants(datagram):
            return
        self._write(1, self._write_frame, frame, datagram)

    def take_topic(self, topic: str, kind: str, data: bytes, heard: int, published: int) -> None:
        """Writes a message of ROS (`heard`, `published`: nanoseconds since 1970, 0 if unknown)."""
        self._write(1, self._write_topic, topic, kind, data, heard, published or heard)

    def _write_frame(self, frame: CapturedFrame, datagram: Datagram | None) -> None:
        self._parts.current.capture.write(frame)
        if datagram is not None:
            for message, packet in self.captured.read([datagram]):
                self.jaus.write(self._parts.current.file, message, packet)

    def _write_topic(self, topic: str, kind: str, data: bytes, heard: int, published: int) -> None:
        definition = self._definition(topic, kind)
        if definition:
            file = self._parts.current.file
            channel = file.ros_channel(topic, kind, definition, self._offers.get(topic))
            file.write(channel, heard, data, published)
            self.topics[topic] += 1

    def _write(self, count: int, do: Callable[..., None], *arguments: Any) -> None:
        """Calls `do` under the lock of the files, unless they can no longer be written.

        Args:
            count: Number of frames and messages that it writes.
        """
        with self._lock:
            self._taken += count
            if self.fault is None:
                try:
                    do(*arguments)
                except OSError as error:
                    self.fault = error

    def _keep(self, period: float, ended: Event, begun: Callable[[], None]) -> None:
        while not ended.wait(period) and self.fault is None:
            now = time.time()
            self._write(0, self._flush)
            try:
                self._parts.current.sync()  # it may take long, so it does not hold the lock
            except OSError as error:
                self.fault = error
            if self.fault is None:
                self.reached, self._kept = now, self._flushed
                self._write(0, self._turn, begun)

    def _flush(self) -> None:
        self._parts.current.flush()
        self._flushed = self._taken

    def _turn(self, begun: Callable[[], None]) -> None:
        if self._parts.turn():
            begun()

    def _definition(self, topic: str, kind: str) -> str:
        """Returns the definition of the type of a topic, empty if it is unknown."""
        key = (topic, kind)
        if key not in self._known:
            definition = installed_definition(kind, self._installation)
            modelled = self._types.get(topic)
            if not definition and modelled is not None:
                definition = modelled_definition(modelled)
            self._known[key] = definition
            if not self._known[key]:
                self.undefined.add(topic)
        return self._known[key]
