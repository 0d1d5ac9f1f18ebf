import socket
import threading
import weakref
from collections.abc import Iterator
from queue import SimpleQueue

import pytest

from jausml.runtime.base.loop import Loop


@pytest.fixture
def loop(clock) -> Iterator[Loop]:
    """A loop that the test drives, on a clock that stands still."""
    with Loop(clock) as made:
        yield made


@pytest.fixture
def running() -> Iterator[Loop]:
    """A loop on its own thread."""
    with Loop() as made:
        made.start()
        yield made


@pytest.fixture
def pair() -> Iterator[tuple[socket.socket, socket.socket]]:
    ends = socket.socketpair()
    for end in ends:
        end.settimeout(5)
    yield ends
    for end in ends:
        end.close()


def test_timers_run_in_order_when_they_are_due(loop, clock):
    ran: list[str] = []
    loop.call_later(2.0, lambda: ran.append("late"))
    loop.call_later(1.0, lambda: ran.append("first"))
    loop.call_at(clock.time + 1.0, lambda: ran.append("second"))
    assert loop.run_once(0) == 0
    clock.time += 1.0
    assert loop.run_once(0) == 2
    clock.time += 1.0
    loop.run_once(0)
    assert ran == ["first", "second", "late"]


def test_a_delay_below_the_resolution_of_the_clock_ends_later(loop, clock):
    clock.time = 2.0**33
    delay = 2.0**-24
    assert clock.time + delay == clock.time
    ran: list[float] = []
    loop.call_later(delay, lambda: ran.append(clock.time))
    assert loop.run_once(0) == 0
    clock.time += 2.0**-19
    assert loop.run_once(0) == 1
    assert ran == [clock.time]


def test_a_cancelled_timer_does_not_run(loop, clock):
    ran: list[str] = []
    first = loop.call_later(1.0, lambda: (second.cancel(), ran.append("first")))
    second = loop.call_later(1.0, lambda: ran.append("second"))
    third = loop.call_later(1.0, lambda: ran.append("third"))
    third.cancel()
    third.cancel()
    clock.time += 1.0
    loop.run_once(0)
    first.cancel()
    assert ran == ["first"]


def test_a_turn_without_a_limit_does_not_wait_for_what_is_due(loop, clock):
    ran: list[str] = []
    loop.call_later(1.0, lambda: ran.append("overdue"))
    loop.call_later(9.0, lambda: ran.append("due"))
    loop.call_later(8.0, lambda: ran.append("cancelled")).cancel()
    clock.time += 3.0
    assert loop.run_once() == 1
    clock.time += 6.0
    assert loop.run_once() == 1
    assert ran == ["overdue", "due"]


def test_what_is_asked_for_soon_does_not_wait_for_a_timer(loop):
    ran: list[str] = []
    loop.call_later(3600.0, lambda: ran.append("timer"))
    loop.call_soon(lambda: ran.append("soon"))
    assert loop.run_once() == 1
    assert ran == ["soon"]


def test_cancelled_timers_do_not_pile_up(loop):
    class Watched:
        def run(self) -> None:
            """Never runs."""

    alive: weakref.WeakSet[Watched] = weakref.WeakSet()
    for _ in range(10_000):
        watched = Watched()
        alive.add(watched)
        loop.call_later(3600.0, watched.run).cancel()
    del watched
    assert not alive
    assert len(loop._timers) < 200


def test_call_soon_runs_in_order_and_not_in_the_same_round(loop):
    ran: list[int] = []
    loop.call_soon(lambda: (ran.append(1), loop.call_soon(lambda: ran.append(3))))
    loop.call_soon(lambda: ran.append(2))
    loop.run_once(0)
    assert ran == [1, 2]
    loop.run_once(0)
    assert ran == [1, 2, 3]


def test_what_a_callback_asks_for_costs_no_wake_up(loop, clock):
    idle: list[bool] = []

    def ask() -> None:
        loop.call_soon(lambda: None)
        loop.call_later(0.5, lambda: None)
        idle.append(loop.is_idle())

    loop.call_soon(ask)
    loop.run_once(0)
    loop.call_later(1.0, ask)
    loop.run_once(0)
    clock.time += 1.0
    loop.run_once(0)
    assert idle == [True, True]


@pytest.mark.parametrize("of", [lambda near: near, socket.socket.fileno], ids=["socket", "number"])
def test_a_readable_descriptor_is_reported_until_read(loop, pair, of):
    near, far = pair
    seen: list[bytes] = []
    loop.register(of(near), lambda: seen.append(near.recv(1)))
    far.sendall(b"ab")
    loop.run_once(5)
    loop.run_once(5)
    assert seen == [b"a", b"b"]
    loop.unregister(of(near))
    loop.unregister(of(near))
    far.sendall(b"c")
    assert loop.run_once(0) == 0


def test_a_number_that_is_registered_anew_in_a_turn_is_not_taken_for_the_former(loop):
    """A descriptor that is closed lends its number to the next that is opened."""
    first, second = socket.socketpair(), socket.socketpair()
    numbers = [socket_pair[0].fileno() for socket_pair in (first, second)]
    called: list[str] = []

    def replace(other: socket.socket, name: str) -> None:
        called.append(name)
        number = other.fileno()
        loop.unregister(other)
        other.close()
        made = socket.socketpair()
        reused = [endpoint for endpoint in made if endpoint.fileno() == number]
        kept.extend(made)
        for endpoint in reused:
            loop.register(endpoint, lambda: called.append("new"))

    kept: list[socket.socket] = []
    loop.register(first[0], lambda: replace(second[0], "first"))
    loop.register(second[0], lambda: replace(first[0], "second"))
    for _, far in (first, second):
        far.sendall(b"x")
    assert loop.run_once(5) == 1
    assert called in (["first"], ["second"])
    assert any(endpoint.fileno() in numbers for endpoint in kept)
    for endpoint in (*first, *second, *kept):
        endpoint.close()


def test_what_is_ready_comes_before_what_is_due(loop, clock, pair):
    """An acknowledgement that has arrived is taken before its packet is sent again."""
    near, far = pair
    called: list[str] = []
    loop.register(near, lambda: called.append(near.recv(1).decode()))
    loop.call_later(1.0, lambda: called.append("timer"))
    far.sendall(b"x")
    clock.time += 1.0
    assert loop.run_once() == 2
    assert called == ["x", "timer"]


def test_a_timer_that_asks_for_the_next_at_once_does_not_hold_up_a_turn(loop, clock):
    ran: list[float] = []

    def again() -> None:
        ran.append(clock.time)
        loop.call_later(0.0, again)

    again()
    assert loop.run_once(0) == 1
    assert loop.run_once(0) == 1
    assert len(ran) == 3


def test_many_ready_descriptors_are_served_in_several_turns_and_timers_between(loop, clock):
    pairs = [socket.socketpair() for _ in range(150)]
    served: list[int] = []
    for number, (near, far) in enumerate(pairs):
        loop.register(
            near, lambda near=near, number=number: served.append(near.recv(1)[0] + number)
        )
        far.sendall(b"\0")
    loop.call_later(1.0, lambda: served.append(-1))
    assert 0 < loop.run_once(5) < 150
    assert not loop.is_idle()
    clock.time += 1.0
    while len(served) < 151:
        assert loop.run_once(5)
    assert sorted(served) == list(range(-1, 150))
    assert served.index(-1) < 149
    assert loop.is_idle()
    for near, far in pairs:
        near.close()
        far.close()


def test_a_socket_is_watched_for_writing_on_demand(loop):
    ours, theirs = socket.socketpair()
    with ours, theirs:
        calls: list[str] = []
        loop.register(ours, lambda: calls.append("ready"))
        loop.run_once(0)
        assert not calls
        loop.watch_writable(ours, wanted=True)
        loop.run_once(0)
        assert calls == ["ready"]
        loop.watch_writable(ours, wanted=False)
        loop.run_once(0)
        assert calls == ["ready"]
        loop.unregister(ours)


def test_a_socket_unregistered_by_an_earlier_callback_is_left_alone(loop):
    pairs = [socket.socketpair() for _ in range(2)]
    called: list[int] = []

    def on_readable(index: int) -> None:
        called.append(index)
        for near, _ in pairs:
            loop.unregister(near)
            near.close()

    for index, (near, far) in enumerate(pairs):
        loop.register(near, lambda index=index: on_readable(index))
        far.sendall(b"x")
    loop.run_once(5)
    assert len(called) == 1
    for _, far in pairs:
        far.close()


def test_a_failing_callback_is_counted_and_the_loop_goes_on(loop, clock, pair):
    near, far = pair

    def fail() -> None:
        raise RuntimeError("boom")

    ran: list[str] = []
    loop.call_soon(fail)
    loop.call_soon(lambda: ran.append("soon"))
    loop.call_later(1.0, fail)
    loop.call_later(1.0, lambda: ran.append("timer"))
    loop.register(near, fail)
    far.sendall(b"x")
    clock.time += 1.0
    loop.run_once(5)
    assert sorted(ran) == ["soon", "timer"]
    assert loop.counters.snapshot() == {"loop.callback_failed": 3}


def test_what_would_end_the_thread_is_counted_or_told_and_the_loop_goes_on(running):
    """User code may raise SystemExit; a process whose loop is gone would be half alive."""
    told: SimpleQueue[object] = SimpleQueue()

    def leave() -> None:
        raise SystemExit(3)

    running.call_soon(leave)
    running.call_soon(lambda: told.put(running.counters.drops()))
    assert told.get(timeout=5) == {"loop.callback_failed": 1}
    running.on_failure = told.put
    running.call_soon(leave)
    error = told.get(timeout=5)
    assert isinstance(error, SystemExit)
    running.call_soon(lambda: told.put("goes on"))
    assert told.get(timeout=5) == "goes on"


@pytest.mark.parametrize("how", ["call_soon", "call_later", "register"])
def test_another_thread_wakes_a_waiting_loop(running, pair, how):
    near, far = pair
    done = threading.Event()
    running.call_soon(done.set)
    assert done.wait(5)
    done.clear()
    if how == "call_soon":
        running.call_soon(done.set)
    elif how == "call_later":
        running.call_later(0.0, done.set)
    else:
        far.sendall(b"x")
        running.register(near, lambda: (near.recv(1), done.set()))
    assert done.wait(5)


def test_callbacks_hold_the_lock(running):
    outcome: list[bool] = []
    done = threading.Event()

    def look_from_elsewhere() -> None:
        def look() -> None:
            outcome.append(running.lock.acquire(blocking=False))

        thread = threading.Thread(target=look)
        thread.start()
        thread.join()
        done.set()

    running.call_soon(look_from_elsewhere)
    assert done.wait(5)
    assert outcome == [False]


def test_a_timer_waits_while_another_thread_holds_the_lock(running):
    done = threading.Event()
    with running.lock:
        timer = running.call_later(0.0, done.set)
        assert not done.wait(0.05)
        timer.cancel()
    later = threading.Event()
    running.call_later(0.0, later.set)
    assert later.wait(5)
    assert not done.is_set()


def test_stop_on_the_own_thread_ends_the_loop():
    loop = Loop()
    loop.start()
    loop.call_soon(loop.stop)
    loop._thread.join(5)
    assert not loop._thread.is_alive()
    loop.stop()
    with pytest.raises(RuntimeError, match="starts once"):
        loop.start()


def test_a_stopped_loop_accepts_late_requests():
    loop = Loop()
    loop.start()
    loop.stop()
    loop.call_soon(lambda: None)
    loop.call_later(1.0, lambda: None).cancel()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        loop.unregister(sock)
