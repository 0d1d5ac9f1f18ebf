"""A recording of ROS through the bridges of a model to JAUS."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.live.recording.errors import RecordingError
from jausml.live.recording.speakers import speakers_of
from jausml.live.workers.code import bridge_code
from jausml.live.workers.process import Worker, WorkerError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from typing_extensions import Self

    from jausml.language.model import Model
    from jausml.live.recording.bags import RosMessage

_WORKER = Path(__file__).with_name("wire_worker.py")
_SECONDS = 60.0


class WireReplay:
    """Bridges on the network; close them at the end, which leaves in good order."""

    def __init__(self, model: Model, transport: dict[str, Any], *, allow_commands: bool) -> None:
        """Opens the bridges.

        Args:
            model: A model without errors, of which nobody makes anything else.

        Raises:
            RecordingError: No bridge has anything to say, or the network cannot be used.
        """
        found = speakers_of(model, allow_commands=allow_commands)
        self.commands = found.commands
        self.published: Counter[str] = Counter()
        self.others: Counter[str] = Counter()
        self.refused: Counter[str] = Counter()
        self.connections: dict[str, dict[str, Any]] = {}
        if not found.bridges:
            hint = "; --allow-commands sends " + ", ".join(found.commands) if found.commands else ""
            raise RecordingError(f"no bridge of the model has reports to give{hint}")
        self._topics = found.topics
        self._worker = Worker(bridge_code(found.model), _WORKER)
        answer = self._ask({"bridges": found.bridges, "transport": transport})
        if "error" in answer:
            self._worker.close()
            raise RecordingError(str(answer["error"]))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stops what is commanded, releases it, and leaves the network."""
        try:
            if self._worker.is_alive:
                self.connections = self._ask({})
        finally:
            self._worker.close()

    def run(self, messages: Iterable[RosMessage]) -> None:
        """Gives the bridges messages as they come."""
        for each in messages:
            if each.topic not in self._topics:
                self.others[each.topic] += 1
                continue
            if each.type != self._topics[each.topic]:
                wanted = self._topics[each.topic]
                self.refused[f"{each.topic} has the type {each.type}, not {wanted}"] += 1
                continue
            fault = self._ask({"message": (each.topic, each.type, each.data.hex())})
            if fault:
                self.refused[fault] += 1
            else:
                self.published[each.topic] += 1

    def _ask(self, request: Any) -> Any:
        try:
            return self._worker.ask(request, _SECONDS)
        except WorkerError as error:
            raise RecordingError(str(error)) from error
