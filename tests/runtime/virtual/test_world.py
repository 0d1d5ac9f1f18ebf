"""Virtual time: what happens in a world, when, and whether it happens again."""

import subprocess
import sys
import time
from datetime import datetime, timedelta, timezone

import pytest

from jausml.runtime import JausAddress, JausComponent
from jausml.runtime.base.clocks import HostClock
from jausml.runtime.base.loop import Loop
from jausml.runtime.virtual import VirtualWorld
from tests.runtime.services.state_tables import V1_1, core_services

CORE = core_services(V1_1, "Transport", "Events", "AccessControl", "Management", "Time")
FIRST = JausAddress(1, 1, 1)


def component(transport, address, name="tested"):
    made = JausComponent(transport, address, name=name, services=CORE)
    made.start()
    return made


class TestTime:
    def test_it_goes_to_what_is_due(self, world):
        times = []
        world.call_at(2.5, lambda: times.append(world.now()))
        world.call_later(0.25, lambda: times.append(world.now()))
        world.run_for(2.0)
        assert times == [0.25]
        assert world.now() == 2.0
        world.run_for(1.0)
        assert times == [0.25, 2.5]

    def test_a_condition_ends_the_run_at_its_time(self, world):
        done = []
        world.call_at(0.75, lambda: done.append(1))
        world.run_until(lambda: done, limit=10)
        assert world.now() == 0.75

    def test_a_condition_that_never_holds(self, world):
        with pytest.raises(TimeoutError, match=r"in 5 s of virtual time \(from 0 s to 5 s\)"):
            world.run_until(lambda: False, limit=5)
        assert world.now() == 5

    def test_time_that_stands_still(self, world):
        def again():
            world.loop.call_soon(again)

        again()
        with pytest.raises(RuntimeError, match="time stands still at 0 s"):
            world.run_for(1)

    @pytest.mark.parametrize("seconds", [-1.0, float("nan")])
    def test_time_does_not_go_back(self, world, seconds):
        with pytest.raises(ValueError, match="time goes on, by 0 s or more"):
            world.run_for(seconds)
        with pytest.raises(ValueError, match="time goes on, by 0 s or more"):
            world.run_until(lambda: False, limit=seconds)

    def test_a_callback_cannot_let_time_pass(self, world):
        said = []

        def wait():
            with pytest.raises(RuntimeError, match="use call_later or call_at") as caught:
                world.run_for(1)
            said.append(caught)

        world.call_later(0.5, wait)
        world.run_for(1)
        assert said
        world.run_for(1)
        assert world.now() == 2

    def test_a_callback_that_fails_is_counted(self, world):
        def fail():
            raise ValueError("no")

        world.call_later(0.1, fail)
        world.run_for(1)
        assert world.counters.snapshot()["loop.callback_failed"] == 1

    def test_the_clock_of_a_component(self):
        start = datetime(2030, 6, 1, 12, 0, 0, 600_000, tzinfo=timezone.utc)
        with VirtualWorld(start=start) as world:
            made = component(world.transport(), FIRST)
            world.run_for(90.25)
            assert made.clock.now() == 90.25
            assert made.clock.utc() == start + timedelta(seconds=90.25)
            assert made.current_time == made.clock.utc() == world.utc()

    def test_beside_a_real_network_it_is_that_of_the_computer(self):
        with Loop() as loop:
            clock = HostClock(loop)
            before = time.monotonic(), datetime.now(timezone.utc)
            now, utc = clock.now(), clock.utc()
            after = time.monotonic(), datetime.now(timezone.utc)
        assert before[0] <= now <= after[0]
        assert before[1] - timedelta(microseconds=1) <= utc <= after[1]

    def test_a_start_without_a_time_zone(self):
        with pytest.raises(ValueError, match="no time zone"):
            VirtualWorld(start=datetime(2030, 1, 1))


def test_nothing_of_it_is_loaded_by_what_runs_on_a_robot():
    script = (
        "import sys, jausml.runtime\n"
        "import jausml.runtime.component.process, jausml.runtime.bridge.process\n"
        "assert not [name for name in sys.modules if 'virtual' in name.split('.')]"
    )
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)
