"""Readers of recordings of ROS: MCAP files, and bags of rosbag2 in any storage."""

from __future__ import annotations

import re
import sqlite3
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

from jausml import installing
from jausml.language.model.files import open_input, read_text
from jausml.live.recording.mcap_files import CDR, WHOLE, RecordingError, TimeSpan
from jausml.live.recording.mcap_reading import (
    UNDEFINED,
    McapRecording,
    RecordedDefinition,
    definition_in,
)
from jausml.live.recording.unpacking import DamageError, unpack_file, unpacked

MCAP, SQLITE = ".mcap", ".db3"
_METADATA = "metadata.yaml"
_JOURNAL = "-wal"
_NUMBERS = re.compile("[0-9]+")


@dataclass(frozen=True)
class RosMessage:
    """A message of ROS in a recording (`time`: nanoseconds since 1970; `data`: CDR)."""

    topic: str
    type: str
    time: int
    data: bytes
    definition: RecordedDefinition = UNDEFINED


_Encoded = tuple[str, RosMessage]  # the name of an encoding, and a message, not only of ROS


def is_bag(path: str) -> bool:
    """Returns whether a path is that of a recording of ROS: by its ending, or as it is a folder."""
    return path.endswith((MCAP, SQLITE)) or Path(path).is_dir()


class Bag:
    """A recording of ROS.

    Attributes:
        others: Numbers of messages that are not of ROS, by their encoding.
        fault: The parts that cannot be read, in words, after all was read; empty for none.
        reached: Time of the latest message so far, in nanoseconds since 1970; None for none.
    """

    def __init__(self, path: str, span: TimeSpan = WHOLE) -> None:
        """Opens nothing yet.

        Args:
            path: An MCAP file, or a bag of rosbag2: its folder, or a file of its storage. Of a
                folder without metadata, since its recorder was cut off, all such files are read.
        """
        self.others: Counter[str] = Counter()
        self.fault = ""
        self.reached: int | None = None
        self._path = path
        self._span = span

    def length(self) -> float | None:
        """Returns the seconds from the first to the last message in the span, None if unknown."""
        if not self._path.endswith(MCAP):
            return None
        try:
            return McapRecording(self._path, self._span).length()
        except (ImportError, RecordingError):
            return None  # `messages` raises the error

    def messages(self) -> Iterator[RosMessage]:
        """Yields messages of ROS in the order of their times, file after file.

        Raises:
            RecordingError: It cannot be opened, is no recording, or no part of it can be read.
        """
        self.others.clear()
        self.fault, self.reached = "", None
        try:
            for encoding, message in self._span.of(self._all(), lambda record: record[1].time):
                if encoding == CDR:
                    yield message
                else:
                    self.others[encoding] += 1
        except ImportError as error:
            raise RecordingError(
                f"{error.name} is missing: {installing.command('record')}"
            ) from error
        except OSError as error:
            raise RecordingError(f"{self._path}: {error.strerror or error}") from error

    def _all(self) -> Iterator[_Encoded]:
        """Yields the messages of all files; notes parts that cannot be read."""
        bag, count = _files_of(self._path), 0
        for path in bag.paths:
            try:
                for record in self._read(path, bag.compression):
                    count += 1
                    yield record
            except RecordingError as error:
                if self.reached is None and path == bag.paths[-1]:
                    raise
                self._note(str(error))
        if count < bag.count:
            self._note(f"{_METADATA} counts {bag.count} messages, and {count} are read")

    def _note(self, fault: str) -> None:
        self.fault = "; ".join(filter(None, (self.fault, fault)))

    def _read(self, path: Path, compression: str) -> Iterator[_Encoded]:
        """Yields the messages of a file, which may be compressed."""
        with ExitStack() as stack:
            if compression == "file":
                path = _unpacked(path, Path(stack.enter_context(tempfile.TemporaryDirectory())))
            read = self._rows if path.suffix == SQLITE else self._records
            for encoding, message in read(path):
                self.reached = max(self.reached or message.time, message.time)
                whole = _unpacked_message(message, path) if compression == "message" else message
                yield encoding, whole

    def _records(self, path: Path) -> Iterator[_Encoded]:
        """Yields the messages of an MCAP file."""
        recording = McapRecording(str(path))
        definitions: dict[tuple[str, bytes], RecordedDefinition] = {}
        try:
            for schema, channel, message in recording.messages():
                encoding, kind, definition = channel.message_encoding, "", UNDEFINED
                if schema is not None:
                    kind, key = schema.name, (schema.encoding, schema.data)
                    definition = definitions.get(key) or definition_in(schema)
                    definitions[key] = definition
                elif encoding == CDR:
                    encoding = "cdr without a type"
                time, data = message.log_time, message.data
                yield encoding, RosMessage(channel.topic, kind, time, data, definition)
        finally:
            if recording.fault and recording.reached is not None:
                self._note(recording.fault)

    def _rows(self, path: Path) -> Iterator[_Encoded]:
        """Yields the messages of a database (rosbag2, sqlite3 storage)."""
        row = None
        try:
            open_input(path).close()  # it raises the usual errors, which sqlite3 does not
            uri = f"{path.resolve().as_uri()}?mode=ro&immutable=1"
            with closing(sqlite3.connect(uri, uri=True)) as database:
                database.text_factory = lambda text: text.decode("utf-8", "replace")
                for row in _messages_in(database):
                    yield row
        except OSError as error:
            raise RecordingError(f"{path}: {error.strerror or error}") from error
        except (sqlite3.Error, ValueError) as error:  # also texts of errors that are no UTF-8
            if row is None:
                what = "cannot be read: it is no database of rosbag2, or damaged"
                raise RecordingError(f"{path} {what}") from error
            self._note(f"the database {path.name} is damaged")
        journal = path.with_name(path.name + _JOURNAL)
        if journal.exists() and journal.stat().st_size:
            how = f"sqlite3 {path.name} 'PRAGMA wal_checkpoint' writes it into {path.name}"
            self._note(f"what stands in {journal.name} is not read; {how}")


def _messages_in(database: sqlite3.Connection) -> Iterator[_Encoded]:
    tables = {
        name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE rootpage > 0")
    }
    if not {"topics", "messages"} <= tables:
        raise sqlite3.DatabaseError
    definitions = {}
    if "message_definitions" in tables:  # since Iron
        for kind, encoding, text in database.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        ):
            definitions[kind] = RecordedDefinition(str(encoding), str(text))
    for topic, kind, encoding, time, data in database.execute(
        "SELECT name, type, serialization_format, timestamp, data"
        " FROM messages JOIN topics ON messages.topic_id = topics.id ORDER BY timestamp"
    ):
        if not (isinstance(time, int) and isinstance(data, bytes)):
            raise sqlite3.DatabaseError
        definition = definitions.get(kind, UNDEFINED)
        yield str(encoding), RosMessage(str(topic), str(kind), time, data, definition)


@dataclass(frozen=True)
class _Files:
    """The files of a recording.

    Attributes:
        compression: The unit of compression: `file`, `message` or empty.
        count: Number of messages by the metadata; 0 without metadata.
    """

    paths: list[Path]
    compression: str = ""
    count: int = 0


def _files_of(path: str) -> _Files:
    """Returns the files of a recording in their order."""
    folder = Path(path)
    if not folder.is_dir():
        return _Files([folder])
    if (folder / _METADATA).exists():
        return _stated_files(folder)
    for ending in (MCAP, SQLITE):
        files = list(folder.glob("*" + ending))
        if files:
            return _Files(sorted(files, key=lambda file: [*map(int, _NUMBERS.findall(file.name))]))
    raise RecordingError(f"{path} cannot be read: it has no {_METADATA}, {MCAP} or {SQLITE} file")


def _stated_files(folder: Path) -> _Files:
    """Returns the files of a bag by its metadata.

    Its topics are not used, as they may have been edited.
    """
    import yaml  # noqa: PLC0415 - an extra

    try:
        stated = yaml.safe_load(read_text(folder / _METADATA))["rosbag2_bagfile_information"]
        paths = [folder / PurePath(path).name for path in stated["relative_file_paths"]]
        compression = str(stated.get("compression_mode") or "none").lower()
        files = _Files(paths, compression, int(stated["message_count"]))
    except (AttributeError, LookupError, TypeError, ValueError, yaml.YAMLError) as error:
        what = f"its {_METADATA} is none of rosbag2"
        raise RecordingError(f"{folder} cannot be read: {what}") from error
    if compression != "none" and stated.get("compression_format") != "zstd":
        how = str(stated.get("compression_format"))[:20]
        raise RecordingError(f"{folder} is compressed by '{how}', which is not read")
    return files


def _unpacked(path: Path, folder: Path) -> Path:
    """Unpacks a compressed file of a bag into a folder, and returns its path there."""
    target = folder / path.stem
    try:
        with open_input(path) as source, target.open("wb") as stream:
            unpack_file(source, stream)
    except DamageError as error:
        raise RecordingError(f"{path} {error}") from error
    return target


def _unpacked_message(message: RosMessage, path: Path) -> RosMessage:
    """Returns a message, unpacked, of a bag that compresses each message."""
    try:
        data = unpacked(message.data, "zstd")
    except DamageError as error:
        raise RecordingError(f"{path}: a message of {message.topic} {error}") from error
    return replace(message, data=data)
