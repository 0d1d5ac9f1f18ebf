#!/bin/sh
# rosbags 0.11.9: the RIHS01 hash of each type with a `char` is not that of ROS 2 Jazzy.
#
# A .msg `char` is a uint8 in ROS 2: rosidl describes the field by type id 3 (uint8), and hashes
# that. rosbags hashes the id of char. So a bag that rosbags writes names std_msgs/msg/Char by a
# hash that no ROS 2 node has, and so are ServiceEventInfo (the gid of a client is char[16]) and the
# graph's own types in rmw_dds_common. Types without a char agree: 118 of the 123 that come with
# rclpy, std_msgs and sensor_msgs. The octets of the messages are the same in both.
#
# Seen: the lines below EXPECTED. The hash of ROS is in the .json beside each installed .msg.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet rosbags==0.11.9 ros-jazzy-std-msgs==5.3.6 \
    "ros-jazzy-rclpy[fastrtps]==7.1.6" ros-jazzy-sensor-msgs==5.3.6

cat > "$folder/hashes.py" <<'PYTHON'
import json
import sys
from pathlib import Path

from rosbags.typesys import Stores, get_types_from_msg, get_typestore

store, types = get_typestore(Stores.EMPTY), {}
share = Path(sys.prefix, "share")
for path in share.glob("*/msg/*.msg"):
    types |= get_types_from_msg(path.read_text(), f"{path.parts[-3]}/msg/{path.stem}")
store.register(types)
agree, differ = [], []
for name in sorted(types):
    package, _, kind = name.split("/")
    description = json.loads((share / package / "msg" / f"{kind}.json").read_text())
    hashes = {entry["type_name"]: entry["hash_string"] for entry in description["type_hashes"]}
    (agree if store.hash_rihs01(name) == hashes[name] else differ).append(name)
print(len(agree), "agree")
print("differ:", *differ)
[field] = json.loads((share / "std_msgs/msg/Char.json").read_text())["type_description_msg"][
    "type_description"
]["fields"]
print("std_msgs/msg/Char in ROS: type id", field["type"]["type_id"])
PYTHON

cat > "$folder/expected" <<'EXPECTED'
118 agree
differ: rmw_dds_common/msg/Gid rmw_dds_common/msg/NodeEntitiesInfo rmw_dds_common/msg/ParticipantEntitiesInfo service_msgs/msg/ServiceEventInfo std_msgs/msg/Char
std_msgs/msg/Char in ROS: type id 3
EXPECTED
"$folder/venv/bin/python" "$folder/hashes.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
