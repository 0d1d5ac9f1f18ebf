"""Status of a connection for `/diagnostics` and the log, from one report to the next."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from ...base.address import JausAddress
from ..ends.topics import TopicFault
from ..reports.diagnostics import FAILURES, FILTERED, NOT_LOST, THINNED, ConnectionStatus, Latency
from ..reports.states import Facts, StateLog, StopReason, judge
from .stopping import Stopping
from .translations import Form, Joined

PERIODS = 3  # of a source, over which its rate is averaged unless diagnostics are slower
FEWEST_FAILURES = 3  # consecutive messages that fail before a connection counts as failed
_MAX_SAMPLES = 1000


class Rate:
    """The rate of arrivals of a connection, averaged over several calls for a slow source.

    Attributes:
        hertz: Messages each second, as of the last update.
        is_slow: Whether that is less than half of what the source promises.
    """

    def __init__(self) -> None:
        self._samples: deque[tuple[float, int]] = deque(maxlen=_MAX_SAMPLES)
        self.hertz = 0.0
        self.is_slow = False

    def update(self, now: float, arrivals: int, declared: float) -> None:
        """Computes the rate from the messages that have arrived until `now`.

        Args:
            arrivals: Number of all messages so far.
            declared: Messages each second that the source promises; 0 if it promises none.
        """
        span = PERIODS / declared if declared > 0 else 0.0
        samples = self._samples
        # The last sample from before the span stays, as the rate is counted from it.
        while len(samples) > 1 and samples[1][0] <= now - span:
            samples.popleft()
        since, before = samples[0] if samples else (now, arrivals)
        samples.append((now, arrivals))
        elapsed = now - since
        self.hertz = (arrivals - before) / elapsed if elapsed > 0 else 0.0
        # Not before a whole span has passed: a source that has just begun is not slow.
        self.is_slow = 0 < span <= elapsed and self.hertz < declared / 2


class _Totals(NamedTuple):
    """Counts of a connection at the time of a report."""

    time: float
    arrivals: int = 0
    dropped: int = 0
    lost: int = 0
    errors: int = 0
    limited: int = 0


class Reporting(Stopping):
    """The part of a connection that reports its status; runs on the loop, or with its lock."""

    form: Form
    override: list[tuple[str, str]]  # methods that a user has overridden, for diagnostics

    def __init__(self, name: str, **when_lost: Any) -> None:
        super().__init__(name, **when_lost)
        self._reported: _Totals | None = None
        self._faults: list[TopicFault] = []
        self._counted_losses: dict[str, int] = {}
        self._rate = Rate()
        self._last_success: tuple[int, dict[str, int]] = (0, {})  # passed; failures until then
        self._states = StateLog(name)
        self._joined: tuple[Joined, ...] = ()
        self._latency: Latency | None = None

    # ------------------------------------------------------------------ for the kinds

    @property
    def declared_rate(self) -> float:
        """Messages each second that the model promises; 0 when it promises none."""
        return 0.0

    def losses(self) -> Mapping[str, int]:
        """Returns how many messages were lost before or behind this connection, by reason."""
        return {}

    def not_taken(self) -> Mapping[str, int]:
        """Returns how many messages the component dropped before this connection, by reason."""
        return {}

    def lacks_peers(self) -> str:
        """Returns which peers are searched for and not found; empty when none are lacking."""
        return ""

    def forbidden(self) -> str:
        """Returns why no message may be passed on now; empty while messages may."""
        return "" if self._halt is None else self._halt.value

    def refusal(self) -> str:
        """Returns why no peer obeys; empty while one does, or none has to."""
        return ""

    def disobeying(self) -> str:
        """Returns which of several peers do not obey; empty while all do, or none does."""
        return ""

    def silent_peers(self) -> Iterable[JausAddress]:
        """Returns the peers that were asked for messages and send none."""
        return ()

    def topic_faults(self) -> Iterable[TopicFault]:
        """Returns the present faults of the topics."""
        return ()

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns names and states of the peers, for diagnostics."""
        raise NotImplementedError

    # ------------------------------------------------------------------ reports

    def note_losses(self) -> int:
        """Counts the losses since the last call; returns the number of all lost messages."""
        counters = self.counters
        total = 0
        for reason, count in {**self.losses(), THINNED: self.statistics.thinned}.items():
            new = count - self._counted_losses.get(reason, 0)
            if new:
                self._counted_losses[reason] = count
                name = f"bridge.{self.name}.{reason}"
                if reason in NOT_LOST:
                    # Left out on purpose: counted, but not logged.
                    counters.add(name, new)
                else:
                    counters.count(name, f"{new} since the last report", amount=new)
            total += 0 if reason in NOT_LOST else count
        return total

    def status(self) -> ConnectionStatus:
        """Returns the state since the last call, for `/diagnostics`."""
        counts, now = self.statistics, self._ends.clock.now()
        present = _Totals(
            now,
            counts.arrivals,
            # Messages that a filter holds back are no losses.
            sum(
                number
                for reason, number in counts.drops.items()
                if reason != FILTERED or not self.filters
            ),
            self.note_losses(),
            counts.errors,
            counts.limited,
        )
        former = self._reported or _Totals(now)
        self._reported = present
        self._rate.update(now, present.arrivals, self.declared_rate)
        faults = self._present_faults()
        verdict = judge(self._facts(former, present, faults))
        self._states.note(verdict, now)
        values = (("state", verdict.phase.value), *self._values(now, faults))
        own = str(self._ends.settings.address)
        return ConnectionStatus(self.name, verdict.level, verdict.reason, own, values)

    def close_account(self) -> list[tuple[str, int]]:
        """Counts the losses since the last status; returns the account of all messages."""
        self.note_losses()
        return self.account()

    def account(self) -> list[tuple[str, int]]:
        """Returns the number of messages for each outcome, by the names that diagnostics show.

        The messages taken are the sum of those passed, thinned and dropped.
        """
        counts = self.statistics
        return [
            ("messages taken", counts.arrivals),
            ("messages passed", counts.passed),
            *(((THINNED, counts.thinned),) if counts.thinned else ()),
            *((f"dropped: {reason}", number) for reason, number in sorted(counts.drops.items())),
            *(
                (f"withheld from {peer}", number)
                for peer, number in sorted(counts.withheld.items())
            ),
            *(
                (f"not taken: {reason}", number)
                for reason, number in sorted(self.not_taken().items())
            ),
            *((reason.replace("_", " "), number) for reason, number in self.losses().items()),
        ]

    def _values(self, now: float, faults: list[TopicFault]) -> tuple[tuple[str, str], ...]:
        """Returns the names and values that diagnostics show, in their order."""
        counts = self.statistics
        age = "never" if counts.last_arrival is None else f"{now - counts.last_arrival:.3f}"
        return (
            ("translation", self.form.value),
            *self.override,
            *((("passed on by the core", str(counts.alone)),) if counts.alone else ()),
            *((name, str(number)) for name, number in self.account()),
            ("rate (Hz)", f"{self._rate.hertz:.2f}"),
            ("declared rate (Hz)", f"{self.declared_rate:.2f}"),
            ("age (s)", age),
            *(
                (f"join {join.name} age (s)", "never" if join.age is None else f"{join.age:.3f}")
                for join in self._joined
            ),
            *((fault.kind.replace("_", " "), fault.text) for fault in faults),
            *((("when lost", self.when_lost),) if self.is_command else ()),
            ("safe values", str(counts.safe_values)),
            *((f"stopped: {reason.value}", str(number)) for reason, number in counts.stops.items()),
            ("values limited", str(counts.limited)),
            *(
                (f"out of range: {policy} {field}", str(number))
                for (policy, field), number in sorted(counts.out_of_range.items())
            ),
            *(() if self._latency is None else self._latency.describe()),
            *self.describe_peers(),
        )

    def stale_joins(self) -> list[str]:
        """Returns the names of the joins without a fresh message."""
        return [join.name for join in self._joined if join.is_stale]

    def _present_faults(self) -> list[TopicFault]:
        """Returns the faults of the topics; counts and logs each when it begins."""
        faults = list(self.topic_faults())
        for fault in faults:
            if fault not in self._faults:
                self.counters.count(f"bridge.{self.name}.{fault.kind}", fault.text)
        self._faults = faults
        return faults

    def _facts(self, former: _Totals, present: _Totals, faults: list[TopicFault]) -> Facts:
        """Returns what the state is judged by."""
        is_heard = self.statistics.last_arrival is not None
        # Where messages arrive and none has passed yet, the reason is a join without a message.
        has_begun = is_heard and self.stopped in (StopReason.START, StopReason.INACTIVE)
        lacks_joins = has_begun and bool(self.stale_joins())
        return Facts(
            error="values out of range" if present.errors > former.errors else "",
            fault=faults[0].text if faults else "",
            lacking=self._lacking(),
            failing=self._failing(),
            stopped=None if lacks_joins else self.stopped,
            forbidden=self.forbidden(),
            is_heard=is_heard,
            refusal=self.refusal(),
            complaint=self._complaint(former, present),
        )

    def _lacking(self) -> str:
        """Returns which peers are missing, or silent from the beginning; empty where none are."""
        if searched := self.lacks_peers():
            return f"searching {searched}"
        if self.statistics.last_arrival is not None:
            return ""
        silent = [str(peer) for peer in self.silent_peers()]
        if not silent:
            return ""
        return f"{' and '.join(silent)} {'does' if len(silent) == 1 else 'do'} not answer"

    def _failing(self) -> str:
        """Returns why no message passes, once several in a row have failed; else an empty text."""
        counts = self.statistics
        failures = {reason: number for reason, number in counts.drops.items() if reason in FAILURES}
        passed, before = self._last_success
        # A message has passed: failures are counted from here on.
        if counts.passed != passed:
            self._last_success = counts.passed, failures
            return ""
        new = {reason: number - before.get(reason, 0) for reason, number in failures.items()}
        if sum(new.values()) < FEWEST_FAILURES:
            return ""
        reason = max(new, key=lambda failure: new[failure])
        text = f"{reason} ({counts.failures.get(reason, '')})"
        return f"no message can be translated: {text}; change its map, or what is sent"

    def _complaint(self, former: _Totals, present: _Totals) -> str:
        """Returns the fault of a connection that passes messages on; empty without one."""
        if stale := self.stale_joins():
            return f"nothing fresh from {', '.join(stale)}"
        if disobeying := self.disobeying():
            return disobeying
        if silent := ", ".join(map(str, self.silent_peers())):
            return f"nothing from {silent}"
        if present.dropped > former.dropped:
            return "messages are dropped"
        if present.lost > former.lost:
            return "messages are lost"
        if self._rate.is_slow:
            return "slower than declared"
        return "values are clamped" if present.limited > former.limited else ""
