"""The radio is away while a stop is sent: it is sent again, as long as the peer would go on."""

import pytest


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
    told = run_script("short_cut.py", f"--restored={restored}")["told"]
    moving = [when for when, speed, _ in told if speed]
    standing = [when for when, speed, _ in told if not speed]
    assert max(moving) == pytest.approx(10.0, abs=0.11)
    assert standing[0] == pytest.approx(stopped, abs=0.01)
