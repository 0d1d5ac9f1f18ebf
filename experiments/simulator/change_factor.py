"""Sets the real-time factor of the simulator, one after the other.

Usage: python change_factor.py FILE FACTOR:SECONDS...

A row with the time and the factor is written to FILE when the simulator has taken it.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import rclpy
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters

PATIENCE = 20.0
"""Seconds in which the simulator must be found, and must answer."""


def main(arguments: list[str]) -> int:
    """Sets one factor after the other; returns 0 when the simulator took all."""
    rclpy.init()
    node = rclpy.create_node("change_factor")
    client = node.create_client(SetParameters, "/simulator/set_parameters")
    if not client.wait_for_service(PATIENCE):
        node.get_logger().error("the simulator is not there")
        return 1
    with Path(arguments[0]).open("w", encoding="utf-8", buffering=1) as file:
        file.write("real_s,factor\n")
        for argument in arguments[1:]:
            factor, seconds = map(float, argument.split(":"))
            value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=factor)
            request = SetParameters.Request(
                parameters=[ParameterMessage(name="real_time_factor", value=value)]
            )
            answer = client.call_async(request)
            rclpy.spin_until_future_complete(node, answer, timeout_sec=PATIENCE)
            if not answer.done() or not answer.result().results[0].successful:
                node.get_logger().error(f"the simulator does not take {factor}")
                return 1
            file.write(f"{time.monotonic()},{factor}\n")
            time.sleep(seconds)
    node.get_logger().info("all factors were set")
    rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
