"""Endpoints of bridges in ROS: which reliability they have where the model leaves it open."""

from generated import model_in

from jausml.language.metamodel.classes import system
from jausml.language.semantics.connections.topics import endpoints
from jausml.language.validation.engine import check_project

MODEL = """
import mappings.global_pose_sensor
import mappings.velocity_state_driver

system fleet {
    component vehicle {
        address: 1.1.1
        provides: VelocityStateDriver
        uses: GlobalPoseSensor
    }
    bridge front {
        address: 1.1.2
        frequency: 10
        provides: GlobalPoseSensor, VelocityStateDriver
        connection pose {
            map: global_pose
            direction: rosToJaus
            exchange: periodicEvent
            topic fix {}
            topic imu { join: imu  qos: { depth: 1 } }
        }
        connection stated {
            map: global_pose
            direction: rosToJaus
            exchange: periodicEvent
            topic stated { qos: { reliability: reliable } }
            topic stated_imu { join: imu  qos: { reliability: system_default } }
        }
        connection latched {
            map: global_pose
            direction: rosToJaus
            exchange: periodicEvent
            topic latched { qos: { durability: transient_local  depth: 1 } }
            topic latched_imu { join: imu  qos: { durability: transient_local } }
        }
        connection command {
            map: velocity_command
            direction: rosToJaus
            exchange: message
            peers: vehicle
            topic cmd_vel {}
        }
        connection obeyed {
            map: velocity_command
            direction: jausToRos
            exchange: message
            topic obeyed { qos: { depth: 1 } }
        }
    }
    node driver {
        publisher fix { topic: fix  type: sensor_msgs/NavSatFix  qos: { reliability: best_effort } }
        subscription imu { topic: imu_in  type: sensor_msgs/Imu  qos: { depth: 3 } }
    }
}
"""


def test_what_becomes_reports_hears_everybody_and_commands_and_latched_are_reliable(
    tmp_path,
):
    fleet = model_in(tmp_path, MODEL).root
    assert isinstance(fleet, system.System)
    found = {end.topic: end.reliability for end in endpoints([*fleet.bridges, *fleet.nodes])}
    assert found == {
        "/fix": "best_effort",
        "/imu": "best_effort",
        "/stated": "reliable",
        "/stated_imu": "system_default",
        "/latched": "reliable",
        "/latched_imu": "reliable",
        "/cmd_vel": "reliable",
        "/obeyed": "reliable",
        "/imu_in": "reliable",
    }
    # A driver that offers its best effort and a report are no finding.
    findings = check_project([tmp_path / "model.ros2jaus"]).diagnostics
    assert "JML403" not in {finding.rule for finding in findings}
