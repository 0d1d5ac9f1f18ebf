"""Runs two generated bridges in virtual time and prints what happened, as JSON.

A ROS node drives by the bridge `station`, whose commands the bridge `vehicle` publishes. The ways
of the vehicle delay and lose.
"""

import argparse
import hashlib
import json
import logging
import sys

from jausml_runtime.virtual import Link, VirtualWorld
from station.ros_types import JointState, Twist
from station.station import Station
from vehicle.vehicle import Vehicle

STREAM = "velocity_command"
JOINTS = "set_pan_tilt_velocities"
SCALE = 100.0
"""What the speed of a command is its time by, which is below the limit of the model then."""


def drive(asked: argparse.Namespace) -> dict[str, object]:
    """Returns what arrived and when, and a digest of all bytes with their times."""
    link = Link(delay=asked.delay, loss=asked.loss)
    arrived: list[tuple[float, float]] = []
    turned: list[tuple[list[str], list[float]]] = []
    digest = hashlib.sha256()
    with VirtualWorld(seed=asked.seed) as world:
        world.watch(lambda now, where, data: digest.update(f"{now!r} {where} ".encode() + data))
        vehicle, station = Vehicle(), Station()
        transport = world.transport(link, link)
        vehicle.open(world.ros_node("vehicle"), transport)
        station.open(world.ros_node("station"), world.transport())
        world.ros.subscribe(
            f"/out/{STREAM}",
            Twist,
            lambda data: arrived.append((world.now(), Twist.from_cdr(data).linear.x)),
        )

        def note(data: bytes) -> None:
            joints = JointState.from_cdr(data)
            turned.append((list(joints.name), [round(velocity, 3) for velocity in joints.velocity]))

        world.ros.subscribe(f"/out/{JOINTS}", JointState, note)

        def turn(names: list[str], velocities: list[float]) -> None:
            joints = JointState(name=names, velocity=velocities)
            world.ros.publish(f"/in/{JOINTS}", JointState, joints.to_cdr())

        world.call_at(1.0, lambda: turn(["wheel", "tilt", "pan"], [9.0, 0.25, 0.5]))
        world.call_at(1.1, lambda: turn(["wheel", "pan"], [9.0, 1.5]))
        world.call_at(1.2, lambda: turn([], [0.75, 0.125]))

        def publish() -> None:
            if world.now() < asked.until:
                twist = Twist()
                twist.linear.x = world.now() / SCALE
                world.ros.publish(f"/in/{STREAM}", Twist, twist.to_cdr())
                world.call_later(0.05, publish)

        world.call_at(1.0, publish)
        if asked.cut:
            world.call_at(asked.cut, transport.cut)
        world.run_for(asked.seconds)
        station.close()
        vehicle.close()
        return {
            "arrived": arrived,
            "turned": turned,
            "digest": digest.hexdigest(),
            "counters": world.counters.snapshot(),
        }


def main() -> None:
    """Reads the command line and prints what happened."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--delay", type=float, default=0.0)
    parser.add_argument("--loss", type=float, default=0.0)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--until", type=float, default=20.0)
    parser.add_argument("--cut", type=float, default=0.0)
    asked = parser.parse_args()
    logging.disable()
    sys.stdout.write(json.dumps(drive(asked)))


main()
