"""What links do to what passes: delays, losses, bursts, copies and order, in figures."""

from itertools import groupby, pairwise

import pytest

from jausml.runtime.virtual import Link, VirtualWorld
from jausml.runtime.virtual.network import LONGEST_HOLD, Path

MANY = 20_000
PERIOD = 0.01


def pass_all(world, link, count=MANY, period=PERIOD):
    """Lets numbered things pass, one in each period; returns (number, delay) as they arrive."""
    path = Path(world.loop, world.random, link)
    arrived = []

    def send(number):
        begun = world.now()
        path.carry(lambda: arrived.append((number, world.now() - begun)))

    for number in range(count):
        world.call_at(number * period, lambda number=number: send(number))
    world.run_for(count * period + 20.0)
    return arrived


def numbers(arrived):
    return [number for number, _ in arrived]


class TestDelay:
    def test_all_takes_as_long_and_stays_in_order(self, world):
        arrived = pass_all(world, Link(delay=0.1), 100)
        assert numbers(arrived) == list(range(100))
        assert all(delay == pytest.approx(0.1, abs=1e-9) for _, delay in arrived)

    def test_what_is_sent_at_once_stays_in_order(self, world):
        path = Path(world.loop, world.random, Link(delay=0.05))
        arrived = []
        for number in range(50):
            path.carry(lambda number=number: arrived.append(number))
        world.run_for(1)
        assert arrived == list(range(50))

    def test_without_any_it_arrives_in_the_next_turn(self, world):
        path = Path(world.loop, world.random, Link())
        arrived = []
        assert path.carry(lambda: arrived.append(world.now()))
        assert not arrived
        world.run_for(0.0)
        assert arrived == [0.0]

    def test_jitter_is_even_and_overtakes(self, world):
        arrived = pass_all(world, Link(delay=0.02, jitter=0.05))
        delays = [delay for _, delay in arrived]
        assert 0.02 <= min(delays) < 0.0201
        assert 0.0699 < max(delays) <= 0.07 + 1e-9
        assert sum(delays) / MANY == pytest.approx(0.045, abs=0.0005)
        assert numbers(arrived) != list(range(MANY))
        assert sorted(numbers(arrived)) == list(range(MANY))

    def test_exponential_delays_have_their_mean(self, world):
        delays = [delay for _, delay in pass_all(world, Link(exponential=0.03))]
        assert sum(delays) / MANY == pytest.approx(0.03, rel=0.05)
        assert sum(delay > 0.03 for delay in delays) / MANY == pytest.approx(0.368, abs=0.02)

    def test_another_link_counts_from_then_on(self, world):
        path = Path(world.loop, world.random, Link(delay=1.0))
        arrived = []
        path.carry(lambda: arrived.append(("former", world.now())))
        path.link = Link(delay=0.25)
        path.carry(lambda: arrived.append(("later", world.now())))
        world.run_for(2)
        assert arrived == [("later", 0.25), ("former", 1.0)]


class TestLoss:
    @pytest.mark.parametrize("loss", [0.0, 0.01, 0.2, 0.5, 1.0])
    def test_its_part_is_lost(self, world, loss):
        arrived = pass_all(world, Link(loss=loss))
        # Four standard deviations.
        assert 1 - len(arrived) / MANY == pytest.approx(
            loss, abs=4 * (loss * (1 - loss) / MANY) ** 0.5
        )

    @pytest.mark.parametrize(("loss", "burst"), [(0.05, 4.0), (0.2, 10.0), (0.5, 2.0)])
    def test_bursts_have_their_mean_length_and_part(self, world, loss, burst):
        kept = set(numbers(pass_all(world, Link(loss=loss, burst=burst))))
        runs = [
            len(list(run)) for there, run in groupby(n in kept for n in range(MANY)) if not there
        ]
        assert sum(runs) / len(runs) == pytest.approx(burst, rel=0.15)
        assert sum(runs) / MANY == pytest.approx(loss, rel=0.2)

    def test_a_way_that_is_cut(self, world):
        path = Path(world.loop, world.random, Link())
        path.is_cut = True
        assert not path.carry(pytest.fail)
        world.run_for(1)


class TestOrder:
    def test_copies(self, world):
        arrived = numbers(pass_all(world, Link(duplicate=0.3)))
        assert len(arrived) / MANY == pytest.approx(1.3, abs=0.02)
        assert sorted(set(arrived)) == list(range(MANY))

    def test_the_next_one_overtakes(self, world):
        arrived = numbers(pass_all(world, Link(delay=0.1, reorder=0.1)))
        overtaken = sum(b < a for a, b in pairwise(arrived))
        assert sorted(arrived) == list(range(MANY))
        # Of two held in a row one descent remains.
        assert overtaken / MANY == pytest.approx(0.09, abs=0.01)

    def test_where_nothing_follows_it_goes_on(self, world):
        path = Path(world.loop, world.random, Link(delay=0.1, reorder=1.0))
        arrived = []
        path.carry(lambda: arrived.append(world.now()))
        world.run_for(5)
        assert arrived == [pytest.approx(LONGEST_HOLD + 0.1)]


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"delay": -0.1}, "delay is -0.1"),
        ({"jitter": float("inf")}, "jitter is inf"),
        ({"exponential": float("nan")}, "exponential is nan"),
        ({"loss": 1.5}, "loss is 1.5; it must lie in 0..1"),
        ({"duplicate": -1}, "duplicate is -1"),
        ({"reorder": 2}, "reorder is 2"),
        ({"loss": 0.1, "burst": 0.5}, "burst is 0.5"),
        ({"loss": 0.1, "burst": float("nan")}, "burst is nan"),
        ({"loss": 0.9, "burst": 2.0}, "a loss of 0.9 takes bursts of at least 9"),
    ],
)
def test_what_no_link_can_do(fields, words):
    with pytest.raises(ValueError, match=words):
        Link(**fields)


def test_what_happens_by_chance_happens_again():
    def arrivals(seed):
        with VirtualWorld(seed=seed) as world:
            link = Link(0.01, 0.05, 0.01, loss=0.2, burst=3, duplicate=0.1, reorder=0.1)
            return pass_all(world, link, 500)

    assert arrivals(1) == arrivals(1)
    assert arrivals(1) != arrivals(2)
