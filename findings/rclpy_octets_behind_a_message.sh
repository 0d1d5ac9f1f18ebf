#!/bin/sh
# rclpy 7.1.6 (ROS 2 Jazzy, Fast DDS): serialize_message returns more octets than a message has.
# rosbags 0.11.9 refuses them; mcap-ros2-support 0.6.0 reads them.
#
# The length is estimated first, and what is returned is as long as the estimate: an empty sequence
# of float64, int64 or uint64 counts the alignment of elements that it does not have. So a
# sensor_msgs/msg/JointState whose driver knows positions alone, or a Float64MultiArray without
# data, has octets behind its end. With all sequences filled, or with elements of four octets, the
# length is right. What one reader of CDR takes, the next calls damage.
#
# Seen: the lines below EXPECTED: octets returned, rosbags, mcap-ros2-support.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet rosbags==0.11.9 mcap==1.6.0 mcap-ros2-support==0.6.0 \
    "ros-jazzy-rclpy[fastrtps]==7.1.6" ros-jazzy-std-msgs==5.3.6 ros-jazzy-sensor-msgs==5.3.6

cat > "$folder/octets.py" <<'PYTHON'
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory
from rclpy.serialization import serialize_message
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, Int32MultiArray

store = get_typestore(Stores.ROS2_JAZZY)
MESSAGES = (
    ("positions alone", JointState(name=["hip"], position=[1.0])),
    ("all filled", JointState(name=["hip"], position=[1.0], velocity=[0.5], effort=[2.0])),
    ("no data", Float64MultiArray()),
    ("some data", Float64MultiArray(data=[1.0])),
    ("no data", Int32MultiArray()),
)
for what, message in MESSAGES:
    package, kind = type(message).__module__.partition(".")[0], type(message).__name__
    name = f"{package}/msg/{kind}"
    octets = serialize_message(message)
    try:
        store.deserialize_cdr(octets, name)
        bags = "reads it"
    except SerdeError as error:
        bags = str(error).partition(" for ")[0]
    definition, _ = store.generate_msgdef(name, ros_version=2)
    schema = Schema(id=1, name=name, encoding="ros2msg", data=definition.encode())
    decoded = DecoderFactory().decoder_for("cdr", schema)(octets)
    values = list(decoded.position if kind == "JointState" else decoded.data)
    print(f"{kind}, {what}", len(octets), bags, values, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
JointState, positions alone | 60 | CDR message size mismatch | [1.0]
JointState, all filled | 76 | reads it | [1.0]
Float64MultiArray, no data | 20 | CDR message size mismatch | []
Float64MultiArray, some data | 28 | reads it | [1.0]
Int32MultiArray, no data | 16 | reads it | []
EXPECTED
"$folder/venv/bin/python" "$folder/octets.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
