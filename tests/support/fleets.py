"""Systems of as many groups as one likes: vehicles, a bridge and eight connections each."""

GROUP = """
    component vehicle_{n} {{
        external: true
        address: {subsystem}.1.1
        provides: PrimitiveDriver, VelocityStateSensor, LocalPoseSensor, Management
    }}

    component operator_{n} {{
        external: true
        address: {subsystem}.2.1
        uses: VelocityStateSensor
        controls: bridge_{n}
    }}

    bridge bridge_{n} {{
        address: {subsystem}.3.1
        provides: Management
        uses: PrimitiveDriver, VelocityStateSensor

        velocity_{n} {{
            JAUS ReportVelocityState
            ROS geometry_msgs/TwistStamped
            JAUS->ROS (
                TimeStamp -> header.stamp : timestamp_to_time {{ whenAbsent: receptionTime }}
                "odom" -> header.frame_id
                Velocity_X -> twist.linear.x {{ whenAbsent: dropMessage }}
                YawRate -> twist.angular.z : negate {{ whenAbsent: dropMessage }}
            )
        }}

        effort_{n} {{
            JAUS SetWrenchEffort
            ROS geometry_msgs/TwistStamped
            ROS->JAUS (
                twist.linear.x -> PropulsiveLinearEffortX : scale(11.0)
                0 -> ResistiveLinearEffortX
            )
        }}
{reports}
        connection command_{n} {{
            map: effort_{n}
            direction: rosToJaus
            peers: vehicle_{n}
            silenceTimeout: 0.5
            topic command_{n}
        }}
    }}
"""
REPORT = """
        /** A report. */
        connection report_{n}_{i} {{
            map: velocity_{n}
            exchange: periodicEvent
            peers: vehicle_{n}
            rate: {rate}
            topic report_{n}_{i}
        }}
"""
ELEMENTS = 34
"""Of a group."""


def fleet(groups: int) -> str:
    """Returns a system of so many groups."""
    inner = "".join(
        GROUP.format(
            n=n,
            subsystem=n % 60000 + 1,
            reports="".join(REPORT.format(n=n, i=i, rate=10 + i) for i in range(7)),
        )
        for n in range(groups)
    )
    return f"system fleet {{\n{inner}}}\n"
