#!/bin/sh
# pypcd4 1.5.1: PointCloud.from_msg reads some clouds of ROS as other points, without a word.
#
# It takes the octets of a sensor_msgs/PointCloud2 one point after the other, with fields as they
# are listed. What the message says besides is not looked at:
# - `row_step`: octets behind a row, which it allows, become points; the cloud has then more points
#   than its width and height say. Where they are no whole points, numpy refuses all.
# - `is_bigendian`: octets of the other order become other numbers.
# - offsets: a field that lies in another one, or is listed behind one of a higher offset, is read
#   behind that, and each later point from a wrong place.
# - `count` 0, which some writers leave for 1: the field is not there, its octets are.
#
# Seen: the lines below EXPECTED: what is special about a cloud of (1, 2, 3), (4, 5, 6), (7, 8, 9)
# and (10, 11, 12) in two rows, and what is read.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pypcd4==1.5.1 numpy==2.2.6 ros-jazzy-rclpy==7.1.6 \
  ros-jazzy-sensor-msgs==5.3.6

cat > "$folder/clouds.py" <<'PYTHON'
import struct

from pypcd4 import PointCloud
from sensor_msgs.msg import PointCloud2, PointField

ROWS = (((1, 2, 3), (4, 5, 6)), ((7, 8, 9), (10, 11, 12)))
X, Y, Z = (
    PointField(name=name, offset=offset, datatype=PointField.FLOAT32, count=1)
    for name, offset in (("x", 0), ("y", 4), ("z", 8))
)
COLOUR = PointField(name="rgba", offset=8, datatype=PointField.UINT32, count=1)
UNCOUNTED = PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=0)


def cloud(fields=(X, Y, Z), order="<", pad=0):
    rows = [b"".join(struct.pack(f"{order}3f", *point) for point in row) for row in ROWS]
    return PointCloud2(
        height=2,
        width=2,
        fields=fields,
        is_bigendian=order == ">",
        point_step=12,
        row_step=24 + pad,
        data=b"".join(row + bytes(pad) for row in rows),
        is_dense=True,
    )


CLOUDS = {
    "nothing": cloud(),
    "12 octets behind a row": cloud(pad=12),
    "8 octets behind a row": cloud(pad=8),
    "big endian": cloud(order=">"),
    "a field in another": cloud((X, Y, Z, COLOUR)),
    "z is listed before y": cloud((X, Z, Y)),
    "count 0": cloud((UNCOUNTED, Y, Z)),
}
for what, message in CLOUDS.items():
    try:
        read = PointCloud.from_msg(message)
    except ValueError as error:
        print(what, error, sep=" | ")
        continue
    points = read.numpy(read.fields).tolist()
    print(what, " ".join(read.fields), *(f"{point}" for point in points), sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
nothing | x y z | [1.0, 2.0, 3.0] | [4.0, 5.0, 6.0] | [7.0, 8.0, 9.0] | [10.0, 11.0, 12.0]
12 octets behind a row | x y z | [1.0, 2.0, 3.0] | [4.0, 5.0, 6.0] | [0.0, 0.0, 0.0] | [7.0, 8.0, 9.0] | [10.0, 11.0, 12.0] | [0.0, 0.0, 0.0]
8 octets behind a row | buffer size must be a multiple of element size
big endian | x y z | [4.600602988224807e-41, 8.96831017167883e-44, 2.304855714121459e-41] | [4.600743118071239e-41, 5.74868682004613e-41, 6.89663052202102e-41] | [8.04457422399591e-41, 9.10844001811131e-44, 5.830802910055564e-42] | [1.1570521419930015e-41, 1.7310239929804465e-41, 2.3049958439678916e-41]
a field in another | x y z rgba | [1.0, 2.0, 3.0, 1082130432.0] | [5.0, 6.0, 7.0, 1090519040.0] | [9.0, 10.0, 11.0, 1094713344.0]
z is listed before y | x __4 __5 __6 __7 z y | [1.0, 0.0, 0.0, 0.0, 64.0, 3.0, 4.0] | [5.0, 0.0, 0.0, 192.0, 64.0, 7.0, 8.0] | [9.0, 0.0, 0.0, 32.0, 65.0, 11.0, 12.0]
count 0 | __0 __1 __2 __3 y z | [0.0, 0.0, 128.0, 63.0, 2.0, 3.0] | [0.0, 0.0, 128.0, 64.0, 5.0, 6.0] | [0.0, 0.0, 224.0, 64.0, 8.0, 9.0] | [0.0, 0.0, 32.0, 65.0, 11.0, 12.0]
EXPECTED
"$folder/venv/bin/python" "$folder/clouds.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
