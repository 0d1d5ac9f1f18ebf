#!/bin/sh
# rosbags 0.11.9 reads constants of a .msg as other values than rosidl_adapter 4.6.6 (ROS 2 Jazzy).
#
# - `uint8 G=010` is ten in ROS 2, where rosidl has int(..., 0) only with a prefix; rosbags: eight.
# - `float64 F=-.5`, `nan`, `inf` are numbers in ROS 2; rosbags keeps the texts as strings.
# - `string S=left # port side`: ROS 2 ends an unquoted text at the `#`; rosbags keeps the comment.
# - `string S="a # b"`: ROS 2 ends this one at the `#` too and keeps the quotation mark before it;
#   rosbags has the text that was meant.
# - `bool B=1` is True in ROS 2, and 1 in rosbags.
# - `uint8 G=0o17` and `int32 I=1_000` are numbers in ROS 2; rosbags refuses the whole message.
# Constants are no part of the RIHS01 hash, so the hash shows none of this.
#
# Seen: the lines below EXPECTED: constant, rosidl_adapter, rosbags.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet rosbags==0.11.9 ros-jazzy-rosidl-adapter==4.6.6

cat > "$folder/constants.py" <<'PYTHON'
from rosbags.typesys import TypesysError, get_types_from_msg
from rosidl_adapter.parser import parse_message_string

CONSTANTS = (
    "uint8 G=010",
    "float64 F=-.5",
    "float32 F=nan",
    "float32 F=inf",
    "string S=left # port side",
    'string S="a # b"',
    "bool B=1",
    "uint8 G=0o17",
    "int32 I=1_000",
    "float64 F=5.",
    "int8 G=-0x10",
)
for constant in CONSTANTS:
    text = f"{constant}\nint32 field\n"
    [ros] = parse_message_string("p", "M", text).constants
    try:
        [(_, _, value)] = get_types_from_msg(text, "p/msg/M")["p/msg/M"][0]
        bags = repr(value)
    except TypesysError:
        bags = "refused"
    print(constant, repr(ros.value), bags, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
uint8 G=010 | 10 | 8
float64 F=-.5 | -0.5 | '-.5'
float32 F=nan | nan | 'nan'
float32 F=inf | inf | 'inf'
string S=left # port side | 'left' | 'left # port side'
string S="a # b" | '"a' | 'a # b'
bool B=1 | True | 1
uint8 G=0o17 | 15 | refused
int32 I=1_000 | 1000 | refused
float64 F=5. | 5.0 | 5.0
int8 G=-0x10 | -16 | -16
EXPECTED
"$folder/venv/bin/python" "$folder/constants.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
