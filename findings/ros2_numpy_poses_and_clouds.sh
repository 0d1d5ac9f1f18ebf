#!/bin/sh
# ros2-numpy 0.0.5: matrices of other rotations, and intensities made of coordinates.
#
# - A pose or transform becomes a matrix by `transformations`, which expects w first and gets x, y,
#   z, w: no rotation becomes a half turn about z, and a quarter turn about z another half turn.
# - The way back has w first for transforms (right by itself, so there and back is another rotation)
#   and x, y, z, w for poses: these survive there and back, and a matrix of a quarter turn becomes a
#   pose of another rotation.
# - Of a point cloud, `intensity` is read as two octets at the *number* of its field instead of its
#   offset and type: with the fields x, y, z, intensity these are the last octet of x and the first of
#   y, whatever the intensity is.
#
# Seen: the lines below EXPECTED.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet ros2-numpy==0.0.5 transformations==2026.1.18 numpy==1.24.2 \
    ros-jazzy-sensor-msgs==5.3.6 ros-jazzy-nav-msgs==5.3.6 ros-jazzy-geometry-msgs==5.3.6

cat > "$folder/converted.py" <<'PYTHON'
import math

import numpy as np
import ros2_numpy
from geometry_msgs.msg import Pose, Quaternion, Transform
from sensor_msgs.msg import PointCloud2, PointField

HALF = math.sqrt(0.5)


def rotation(quaternion):
    return " ".join(f"{getattr(quaternion, part) + 0.0:.3f}" for part in "xyzw")


def axes(matrix):
    """Returns where a matrix takes the axes x and y."""
    return "; ".join(" ".join(str(round(value)) for value in matrix[:3, axis]) for axis in (0, 1))


def line(*texts):
    print(*texts, sep=" | ")


for name, turn in (("no turn", Quaternion(w=1.0)), ("quarter turn", Quaternion(z=HALF, w=HALF))):
    matrix = ros2_numpy.numpify(Pose(orientation=turn))
    line(name, "x and y become", axes(matrix))
    line(name, "pose there and back", rotation(ros2_numpy.msgify(Pose, matrix).orientation))
    matrix = ros2_numpy.numpify(Transform(rotation=turn))
    line(name, "transform there and back", rotation(ros2_numpy.msgify(Transform, matrix).rotation))
matrix = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
line("matrix of a quarter turn", "pose", rotation(ros2_numpy.msgify(Pose, matrix).orientation))
line("the same", "transform", rotation(ros2_numpy.msgify(Transform, matrix).rotation))

points = np.array([[1.0, 2.0, 3.0, 0.5], [1.0, 2.0, 3.0, 200.0], [-1.0, 2.0, 3.0, 0.5]], np.float32)
cloud = PointCloud2(
    height=1,
    width=len(points),
    fields=[
        PointField(name=name, offset=4 * number, datatype=PointField.FLOAT32, count=1)
        for number, name in enumerate(("x", "y", "z", "intensity"))
    ],
    point_step=16,
    row_step=16 * len(points),
    data=points.tobytes(),
)
line("intensities", *points[:, 3])
line("ros2-numpy", *ros2_numpy.numpify(cloud)["intensity"].ravel())
PYTHON

cat > "$folder/expected" <<'EXPECTED'
no turn | x and y become | -1 0 0; 0 -1 0
no turn | pose there and back | 0.000 0.000 0.000 -1.000
no turn | transform there and back | 0.000 0.000 -1.000 0.000
quarter turn | x and y become | -1 0 0; 0 0 1
quarter turn | pose there and back | 0.000 0.000 -0.707 -0.707
quarter turn | transform there and back | 0.000 -0.707 -0.707 0.000
matrix of a quarter turn | pose | 0.707 0.000 0.000 0.707
the same | transform | 0.000 0.000 0.707 0.707
intensities | 0.5 | 200.0 | 0.5
ros2-numpy | 63 | 63 | 191
EXPECTED
"$folder/venv/bin/python" "$folder/converted.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
