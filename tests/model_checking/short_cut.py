"""The radio is away for a moment while the source of a command falls silent; prints what came."""

import argparse
import json
import logging
import sys

from jausml_runtime.virtual import VirtualWorld
from rover.rover import Rover
from station.ros_types import Twist
from station.station import Station


class Driven(Rover):
    """Keeps what it is told."""

    def __init__(self, transport, world):
        super().__init__(transport)
        self.world, self.told = world, []

    def on_set_velocity_command(self, message, _sender):
        self.told.append((self.world.now(), message.velocity_x, self.status.name))

    def on_not_ready(self):
        self.told.append((self.world.now(), 0.0, self.status.name))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--cut", type=float, default=10.0)
    parser.add_argument("--restored", type=float, default=11.8)
    asked = parser.parse_args()
    logging.disable()
    with VirtualWorld() as world:
        rover = Driven(world.transport(), world)
        station, transport = Station(), world.transport()
        rover.start()
        station.open(world.ros_node("station"), transport)

        def publish():
            if world.now() < asked.cut:
                twist = Twist()
                twist.linear.x = 1.0
                world.ros.publish("/in/velocity", Twist, twist.to_cdr())
                world.call_later(0.1, publish)

        world.call_at(2.0, publish)
        world.call_at(asked.cut, transport.cut)
        world.call_at(asked.restored, transport.restore)
        world.run_for(60.0)
        sys.stdout.write(json.dumps({"told": rover.told[-4:], "status": rover.status.name}))
        station.close()


main()
