#!/bin/sh
# AHRS 0.4.0: of matrices that are exact half turns, three of five methods make other rotations.
#
# A matrix of a half turn is symmetric; fixed changes of frames (forward to backward, ENU to NED) are
# such matrices, of whole numbers. The signs of a quaternion are then lost in differences of elements
# that are equal:
# - `chiaverini` returns the identity for each of them, so that a rear sensor looks ahead; nan for
#   those in an array of matrices;
# - `hughes` and `sarabandi` are right for ENU to NED, and return the same for the half turn about
#   the other diagonal.
# `shepperd` (the default of `DCM.to_quaternion`) and `itzhack` are right for all, up to the sign of
# the whole, and so are all five a thousandth of a degree beside.
#
# Seen: the lines below EXPECTED: a method, then what it makes of each rotation: "right", or the
# quaternion (w x y z).
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet ahrs==0.4.0 numpy==2.2.6

cat > "$folder/turns.py" <<'PYTHON'
import warnings

import numpy as np
from ahrs import DCM, Quaternion
from ahrs.common import orientation

warnings.simplefilter("ignore")  # numpy tells of the division 0 / 0
TURNS = {
    "backward": np.diag([-1.0, -1.0, 1.0]),
    "ENU to NED": np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]),
    "other diagonal": np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]),
}
angle = np.radians(179.999)
TURNS["almost backward"] = np.array(
    [[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]]
)


def verdict(quaternion, matrix):
    if np.isnan(quaternion).all():
        return "nan"
    if np.allclose(Quaternion(quaternion).to_DCM(), matrix, atol=1e-6):
        return "right"
    return " ".join(f"{value + 0.0:.3f}" for value in np.round(quaternion, 3))


for method in ("chiaverini", "hughes", "sarabandi", "shepperd", "itzhack"):
    made = [verdict(DCM(turn).to_quaternion(method=method), turn) for turn in TURNS.values()]
    print(method, *made, sep=" | ")
array = np.stack(list(TURNS.values()))
made = zip(orientation.chiaverini(array), array, strict=True)
print("chiaverini of an array", *(verdict(*pair) for pair in made), sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
chiaverini | 1.000 0.000 0.000 0.000 | 1.000 0.000 0.000 0.000 | 1.000 0.000 0.000 0.000 | right
hughes | right | right | 0.000 0.707 0.707 0.000 | right
sarabandi | right | right | 0.000 0.707 0.707 0.000 | right
shepperd | right | right | right | right
itzhack | right | right | right | right
chiaverini of an array | nan | nan | nan | right
EXPECTED
"$folder/venv/bin/python" "$folder/turns.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
