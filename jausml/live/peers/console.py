"""Interactive session of an operator: each line is a command, followed by its outcome."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from jausml.live.messages import MessageEntry, MessageError
from jausml.live.messages.errors import did_you_mean, similar
from jausml.live.messages.field_paths import parse_fields
from jausml.live.messages.text import paths_of
from jausml.live.peers.discovery import label_of
from jausml.live.peers.operator import Operator
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.peers.rendering import report_line, service_lines, status_line, subsystem_lines
from jausml.live.peers.requesting import outcome, request
from jausml.runtime import EventSubscription, HandoffDecision
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import Resume, Standby
from jausml.runtime.services.definitions import Status

DEFAULT_AUTHORITY = 205  # authority code of an operator control unit, as other stacks choose it
_DECISIONS = (
    ("grant", "hand control over to who asked for it", HandoffDecision.GRANTED),
    ("deny", "keep control that somebody asked for", HandoffDecision.DENIED),
    ("defer", "let somebody wait who asked for control", HandoffDecision.WAIT),
)
_DECISION_TEXTS = {
    HandoffDecision.GRANTED: "granted control",
    HandoffDecision.DENIED: "denied",
    HandoffDecision.WAIT: "to wait",
}
# Commands that name a report, and those that name a message to send.
_REPORTING = ("query", "watch")
_SENDING = ("command", "request", "send")


def _continuations(
    operator: Operator,
    commands: Mapping[str, ConsoleCommand],
    target: JausAddress | None,
    words: list[str],
) -> Iterable[str]:
    """Returns the words that may follow the words of a line.

    Messages and fields are those of the services of the component, as far as these are known; no
    query is sent for them.
    """
    command, *rest = words
    ids = {str(sender): sender for sender in operator.senders()}
    if rest and rest[0] in ids:
        target, rest = ids[rest[0]], rest[1:]
    elif not rest and command in commands and commands[command].takes_id:
        return [*ids, *_message_names(operator, target, command)]
    if command not in (*_REPORTING, *_SENDING):
        return []
    return _fields(operator, target, rest) if rest else _message_names(operator, target, command)


def _message_names(operator: Operator, target: JausAddress | None, command: str) -> list[str]:
    """Returns the messages or reports that a command may name; none for other commands.

    They are those that the component takes; all known ones if its services are not known.
    """
    if command in _REPORTING:
        return [
            message.name.removeprefix("Query")
            for message in _inputs(operator, target)
            if message.name.startswith("Query")
        ]
    return [message.name for message in _inputs(operator, target)] if command in _SENDING else []


def _inputs(operator: Operator, target: JausAddress | None) -> Iterator[MessageEntry]:
    """Yields the messages that a component takes; all known ones if its services are not known."""
    provided = () if target is None else operator.survey.services(target)
    labels = set(map(label_of, provided))
    for service in operator.catalogue.services.values():
        if not labels or service.label in labels:
            for owner in service.lineage:
                yield from owner.inputs


def _fields(operator: Operator, target: JausAddress | None, words: list[str]) -> list[str]:
    """Returns the paths of the fields that a line does not have yet, each with its `=`."""
    name, *arguments = words
    entry = next((message for message in _inputs(operator, target) if message.name == name), None)
    if entry is None:
        return []
    try:
        paths = [f"{path}=" for path in paths_of(entry)]
    except MessageError:
        return []
    return [path for path in paths if not any(word.startswith(path) for word in arguments)]


class UsageError(Exception):
    """A command that cannot be understood; the text says why."""


@dataclass(frozen=True)
class ConsoleCommand:
    """A command of the session.

    `run` gets the rest of the line; before it, with an id in `usage`, the address of the component.
    """

    usage: str
    help: str
    run: Callable[..., None]

    @property
    def takes_id(self) -> bool:
        """Whether its first word may be a JAUS id."""
        return "ID" in self.usage


class Console:
    """The commands of a session of one operator.

    A command may name a component; without one it is for the component named last.

    Attributes:
        failures: Number of commands that failed.
        has_doubts: Whether a sent message may have had no effect.
    """

    def __init__(self, operator: Operator, emit: Callable[[str], None]) -> None:
        self.failures = 0
        self.has_doubts = False
        self._operator = operator
        operator.handoffs.on_news = lambda news: emit(f"note: {news}")
        self._emit = emit
        self._target: JausAddress | None = None
        self._emergencies: set[JausAddress] = set()
        self._watches: dict[tuple[JausAddress, str], EventSubscription] = {}
        self.commands = {
            "discover": ConsoleCommand(
                "[SECONDS]", "find subsystems and components", self._discover
            ),
            "target": ConsoleCommand(
                "ID", "choose the component for the next commands", self._choose
            ),
            "services": ConsoleCommand("[ID]", "list its services", self._services),
            "status": ConsoleCommand("[ID]", "show its state and who controls it", self._status),
            "query": ConsoleCommand("[ID] MESSAGE [FIELDS]", "ask for a report", self._query),
            "watch": ConsoleCommand("[ID] MESSAGE [HZ]", "show a report live", self._watch),
            "unwatch": ConsoleCommand("", "stop showing reports", self._unwatch),
            "control": ConsoleCommand(
                "[ID] [AUTHORITY]", "take control and keep it", self._control
            ),
            "handoff": ConsoleCommand(
                "[ID] [AUTHORITY] [REASON]", "ask whoever controls it for control", self._handoff
            ),
            **{
                name: ConsoleCommand("[ID] NUMBER", text, partial(self._decide, decision))
                for name, text, decision in _DECISIONS
            },
            "resume": ConsoleCommand("[ID]", "bring it to Ready", self._resume),
            "standby": ConsoleCommand("[ID]", "bring it to Standby", self._standby),
            "request": ConsoleCommand(
                "[ID] MESSAGE [FIELDS]", "send a message and wait for its answer", self._request
            ),
            "send": ConsoleCommand("[ID] MESSAGE [FIELDS]", "send a message", self._send),
            "release": ConsoleCommand("[ID]", "release control", self._release),
            "emergency": ConsoleCommand("[ID]", "set an emergency", self._emergency),
            "clear": ConsoleCommand("[ID]", "clear our emergency", self._clear),
            "wait": ConsoleCommand("SECONDS", "wait while reports are shown", self._wait),
            "help": ConsoleCommand("", "show this list", self._help),
            "quit": ConsoleCommand("", "release control, cancel reports, and quit", lambda _: None),
        }

    def run(self, lines: Iterable[str]) -> None:
        """Carries out commands until `quit` or the last line; `#` starts a remark."""
        for line in lines:
            word, _, rest = line.strip().partition(" ")
            if word in ("quit", "exit"):
                break
            if word and not word.startswith("#"):
                self.execute(word, rest.strip())
        for hold in self._operator.holds:
            self._report_doubts(hold.target)
        for target in sorted(self._emergencies):
            self._emit(
                f"note: our emergency of {target} lasts; 'clear' under --id {self._operator.own} "
                "ends it"
            )

    def completions(self, line: str) -> list[str]:
        """Returns the possible last words of a line, which begin as its last word does."""
        *before, beginning = line.split(" ")
        words = [word for word in before if word]
        candidates: Iterable[str] = self.commands
        if words:
            candidates = _continuations(self._operator, self.commands, self._target, words)
        return sorted(
            candidate
            for candidate in set(candidates)
            if candidate.lower().startswith(beginning.lower())
        )

    def execute(self, word: str, rest: str) -> None:
        """Carries out one command; emits and counts its error."""
        command = self.commands.get(word)
        try:
            if command is None:
                raise UsageError(
                    f"no command '{word}'{did_you_mean(similar(word, self.commands)) or ';'} "
                    "'help' lists them"
                )
            command.run(*(self._split_target(rest) if command.takes_id else (rest,)))
        except UsageError as error:
            usage = f"; usage: {word} {command.usage}".rstrip() if command else ""
            self._fail(f"{error}{usage}")
        except (NoAnswer, Refused, MessageError, ValueError) as error:
            self._fail(str(error))

    def _fail(self, text: str) -> None:
        self.failures += 1
        self._emit(f"error: {text}")

    # ---- queries ----------------------------------------------------------------------------

    def _discover(self, rest: str) -> None:
        subsystems = self._operator.survey.take(_number(rest, 2.0))
        for line in subsystem_lines(subsystems):
            self._emit(line)
        if not subsystems:
            raise NoAnswer(self._operator.nothing_heard)

    def _choose(self, target: JausAddress, _rest: str) -> None:
        self._emit(f"target {target}")

    def _services(self, target: JausAddress, _rest: str) -> None:
        services = self._operator.services(target)
        if not services:
            raise self._operator.unanswered(target, "QueryServices", "ReportServices")
        for line in service_lines(services):
            self._emit(line)

    def _status(self, target: JausAddress, _rest: str) -> None:
        self._emit(f"{target} {status_line(*self._operator.status(target))}")

    def _query(self, target: JausAddress, rest: str) -> None:
        name, fields = _message(rest)
        entry, answer = self._operator.query(target, name, fields)
        self._emit(report_line(target, entry, answer))

    def _watch(self, target: JausAddress, rest: str) -> None:
        words = shlex.split(rest)
        if not words:
            raise UsageError("which report?")
        rate = _number(words[1], 0.0) if len(words) > 1 else None

        def show(entry: MessageEntry, fields: dict[str, Any]) -> None:
            self._emit(report_line(target, entry, fields))

        former = self._watches.pop((target, words[0]), None)
        if former is not None:
            former.cancel()
        self._watches[target, words[0]] = self._operator.watch(target, words[0], rate, show)

    def _unwatch(self, _rest: str) -> None:
        for subscription in self._watches.values():
            subscription.cancel()
        self._watches.clear()

    def _wait(self, rest: str) -> None:
        if not rest:
            raise UsageError("how many seconds?")
        time.sleep(_number(rest, 0.0))

    def _help(self, _rest: str) -> None:
        for name, command in self.commands.items():
            self._emit(f"{f'{name} {command.usage}'.rstrip():28} {command.help}")

    # ---- commands ---------------------------------------------------------------------------

    def _control(self, target: JausAddress, rest: str) -> None:
        authority = int(_number(rest, DEFAULT_AUTHORITY))
        self._operator.control(target, authority, lambda news: self._changed(target, news))
        self._emit(f"{target} is controlled")

    def _handoff(self, target: JausAddress, rest: str) -> None:
        word, _, reason = rest.partition(" ")
        authority = int(_number(word, DEFAULT_AUTHORITY))
        self._operator.request_handoff(
            target, authority, reason.strip(), lambda news: self._changed(target, news)
        )
        self._emit(f"{target} is controlled")

    def _decide(self, decision: HandoffDecision, target: JausAddress, rest: str) -> None:
        if not rest:
            raise UsageError("which request?")
        client = self._operator.decide_handoff(target, int(_number(rest, 0)), decision)
        self._emit(f"{target} is told that {client} is {_DECISION_TEXTS[decision]}")

    def _changed(self, target: JausAddress, news: str) -> None:
        """Emits a change of control, and queries state and controller; on the loop's thread."""
        self._emit(f"note: {target} {news}")
        self._operator.look(target, lambda text: self._emit(f"note: {target} {text}"))

    def resume(self, target: JausAddress) -> None:
        """Brings a component that we control to Ready, and emits its state."""
        self._change(target, Resume(), Status.READY)

    def release(self, target: JausAddress) -> None:
        """Releases control, and emits whether the component confirms it."""
        self._report_doubts(target)
        is_confirmed = self._operator.release(target)
        self._emit(f"{target} is released" if is_confirmed else f"{target} confirms no release")

    def _report_doubts(self, target: JausAddress) -> None:
        """Emits the number of messages that may have had no effect, if there are any."""
        hold = next(
            (active_hold for active_hold in self._operator.holds if active_hold.target == target),
            None,
        )
        if hold is not None and hold.doubtful:
            self.has_doubts = True
            self._emit(f"note: {outcome('messages', hold)}")

    def _resume(self, target: JausAddress, _rest: str) -> None:
        self._require_control(target)
        self.resume(target)

    def _standby(self, target: JausAddress, _rest: str) -> None:
        self._require_control(target)
        self._change(target, Standby(), Status.STANDBY)

    def _change(self, target: JausAddress, command: Resume | Standby, state_after: Status) -> None:
        state = self._operator.change(target, command, state_after)
        self._emit(f"{target} is in {state.name}" if state else f"{target} does not tell its state")

    def _send(self, target: JausAddress, rest: str) -> None:
        name, fields = _message(rest)
        entry = self._operator.find(target, name)
        message = self._operator.message(entry, fields or {})
        if entry.is_command and not self._operator.controls(target):
            self._emit(f"note: {target} is not controlled by us; it may ignore {entry.name}")
        self._operator.send(target, message)
        self._emit(f"{entry.name} sent to {target}")

    def _request(self, target: JausAddress, rest: str) -> None:
        name, fields = _message(rest)
        self._emit(report_line(target, *request(self._operator, target, name, fields)))

    def _release(self, target: JausAddress, _rest: str) -> None:
        self.release(target)

    def _emergency(self, target: JausAddress, _rest: str) -> None:
        self._emergencies.add(target)
        self._operator.emergency(target)
        self._emit(f"{target} {status_line(*self._operator.status(target))}")

    def _clear(self, target: JausAddress, _rest: str) -> None:
        self._operator.clear(target)
        self._emergencies.discard(target)
        self._emit(f"{target} {status_line(*self._operator.status(target))}")

    # ---- arguments --------------------------------------------------------------------------

    def _split_target(self, rest: str) -> tuple[JausAddress, str]:
        """Returns the component of a command, and the rest of its line."""
        word, _, after = rest.partition(" ")
        if word[:1].isdigit() and word.count(".") == 2:
            address = JausAddress.parse(word)
            if not address.is_concrete:
                raise UsageError(f"{word} does not name one component")
            if address != self._target:
                self._operator.survey.ask(address)  # for its services, by which words are completed
            self._target = address
            return address, after.strip()
        if self._target is None:
            raise UsageError("which component? name its id, e.g. 100.1.1")
        return self._target, rest

    def _require_control(self, target: JausAddress) -> None:
        if not self._operator.controls(target):
            raise UsageError(f"{target} is not controlled by us: 'control {target}' first")


def _message(rest: str) -> tuple[str, dict[str, Any] | None]:
    name, _, text = rest.partition(" ")
    if not name:
        raise UsageError("which message?")
    return name, parse_fields(text) if text.strip() else None


def _number(text: str, default: float) -> float:
    if not text:
        return default
    try:
        number = float(text)
    except ValueError:
        raise UsageError(f"'{text}' is no number") from None
    if not 0 <= number <= 86400:
        raise UsageError(f"{text} is out of range")
    return number
