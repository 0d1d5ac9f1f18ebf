"""Options that have no effect beside others are refused, and nothing is written."""

import shlex

import pytest


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("init d --hold cmd_vel=brakes", "--hold: only with --from topics"),
        ("init d --from igvc --joints x=a,b --side operator", "--side, --joints: only with"),
        ("init d --copies --from example --name foo", "--name, --from: not with --copies"),
        ("init d --copies odom:nav_msgs/Odometry", "takes no SOURCE"),
        ("init . --copies", "is no project"),
        ("new --format json component foo", "--format: only with --open"),
        ("new connection scan:sensor_msgs/LaserScan --for 3", "--for: only with --from-graph"),
        ("new bridge b scan:sensor_msgs/LaserScan --for 3", "--for: only with --from-graph"),
        ("replay e.mcap -o o.mcap --with-jaus", "--with-jaus: not where an MCAP file is copied"),
        (
            "replay e.mcap -o o.mcap --ros-only --count 1 --loop --bridge-address 1.1.1",
            "--loop, --count, --bridge-address: not where an MCAP file is copied",
        ),
        ("replay e.mcap m.xmi --force", "--force: only with --output"),
        ("replay e.pcap m.xmi -o o.mcap --count 1", "--count: only where a ROS recording goes to"),
        ("replay e.pcap m.xmi -o o.mcap --loop --allow-commands", "--loop, --allow-commands: only"),
        ("decode --pcap e.pcap --duration 3", "--duration: only with --listen"),
        ("decode --pcap e.pcap --datagram", "--datagram: only with hex"),
        ("decode --listen --datagram --duration 0", "--datagram: only with hex"),
        ("decode 0220 --port 4000", "--port: only with --pcap or --listen"),
        ("decode 0220 --interface 127.0.0.1", "--interface: only with --listen"),
        ("validate e.pcap --frequency 5", "--frequency: only with --bridge-address"),
        ("convert a.xmi b.ros2jaus --frequency 5", "--frequency: only with --bridge-address"),
        (
            'new map m A b/C --direction to-ros --to-jaus "a=b"',
            "--to-jaus: not with --direction to-ros",
        ),
        (
            'new map m A b/C --direction to-jaus --to-ros "a=b"',
            "--to-ros: not with --direction to-jaus",
        ),
        ("new map m A b/C --joints a,b --zeros-stop", "--zeros-stop: not with --joints"),
        ("new map m A b/C --joints a,b --fill", "--fill: not with --joints"),
        ("new map m A b/C --copy x --fill", "--fill: not with --copy"),
    ],
)
def test_what_would_have_no_effect_is_refused(jausml, here, line, told):
    for name in ("e.pcap", "e.mcap"):
        (here / name).touch()
    done = jausml(*shlex.split(line))
    assert (done.exit_code, told in done.stderr) == (2, True), done.output
    assert done.stdout == ""
    assert {path.name for path in here.iterdir()} == {"e.pcap", "e.mcap"}
