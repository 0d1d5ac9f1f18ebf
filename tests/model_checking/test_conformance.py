"""The abstract machines do what the runtime does: random walks through both, in virtual time."""

from pathlib import Path

import pytest
from sweeps import sweep

LISTER = Path(__file__).with_name("lister.ros2jaus")
# Of what the abstract ones can be like but for their timers, which walks go through.
OBEYING = {
    "front.velocity": 13,
    "front.effort": 13,
    "front.speed": 12,
    "front.waypoint": 18,
    "rear.effort": 10,
}


@pytest.mark.parametrize("subject", sweep(OBEYING, every=5))
def test_a_bridge_that_obeys(subject, run_script):
    happened = run_script("walk.py", subject)
    assert happened["difference"] is None
    assert happened["states"] >= OBEYING[subject]
    assert happened["steps"] > 1000


@pytest.mark.slow
def test_a_bridge_that_drives_along_lists(run_script):
    happened = run_script("walk_list.py", "lister.along", model=LISTER)
    assert happened["difference"] is None
    assert happened["states"] >= 10
    assert happened["steps"] > 1000


@pytest.mark.slow
def test_a_bridge_and_its_peer(run_script):
    happened = run_script("walk_peer.py")
    assert happened["difference"] is None
    assert happened["states"] >= 15
    assert happened["steps"] > 2000
    assert 1.0 < happened["longest"] <= happened["bound"]


@pytest.mark.slow
def test_a_stop_that_is_sent_once_is_noticed_by_a_walk(run_script):
    difference = run_script("walk_peer.py", "--once")["difference"]
    assert difference["real"]["moves"]
    assert not difference["abstract"]["moves"]
    assert difference["real"]["stopped"]


@pytest.mark.parametrize(
    ("restored", "stopped"),
    [
        pytest.param(11.3, 11.5, id="while the stop is repeated"),
        pytest.param(11.8, 12.0, id="when its repetition was given up"),
        pytest.param(12.5, 12.6, id="just before control lapses"),
        pytest.param(20.0, 12.75, id="after control has lapsed"),
    ],
)
def test_a_stop_arrives_once_the_radio_is_back(restored, stopped, run_script):
    """It is sent again, as long as the peer would go on."""
    told = run_script("short_cut.py", f"--restored={restored}")["told"]
    moving = [when for when, speed, _ in told if speed]
    standing = [when for when, speed, _ in told if not speed]
    assert max(moving) == pytest.approx(10.0, abs=0.11)
    assert standing[0] == pytest.approx(stopped, abs=0.01)
