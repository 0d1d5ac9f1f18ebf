#!/bin/sh
# NavPy 1.0: `ecef2lla` has no latitude on the equator, and heights that are wrong beside the poles.
#
# Earth-centred positions (metres) are turned into latitude, longitude and height by an iteration
# until the latitude changes by less than 1e-10 rad:
# - where z is exactly 0 the latitude is nan, with longitude and height right;
# - in an array the iteration then ends at once for all: one vehicle on the equator moves the height
#   of another one at 52 degrees by two metres, which is right to 0.1 mm without it;
# - close to a pole the height is too large by 0.67 %, the square of the second eccentricity: 67 m at
#   10 km. It begins 0.01 degrees from it at 100 m, 0.00001 at 100 km; at the pole it is right.
# pymap3d 3.2.0 returns what was given, for all of them.
#
# Seen: the lines below EXPECTED: what was given, what NavPy and pymap3d return of its position; the
# last one is the first again, in an array with the second.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet NavPy==1.0 pymap3d==3.2.0 numpy==2.2.6

cat > "$folder/positions.py" <<'PYTHON'
import warnings

import navpy
import numpy as np
import pymap3d

warnings.simplefilter("ignore")  # numpy tells of the division 0 / 0


def shown(latitude, longitude, height):
    return f"{latitude:.6f} {longitude:.6f} {height:.1f}"


def line(given, returned):
    position = pymap3d.geodetic2ecef(*given)
    print(shown(*given), returned, shown(*pymap3d.ecef2geodetic(*position)), sep=" | ")


north, equator = (52.0, 10.0, 500.0), (0.0, 10.0, 500.0)
for given in (north, equator, (89.0, 10.0, 1e4), (89.9999, 10.0, 1e4), (-89.9999, 10.0, 1e4)):
    line(given, shown(*navpy.ecef2lla(pymap3d.geodetic2ecef(*given))))
together = navpy.ecef2lla(np.array([pymap3d.geodetic2ecef(*given) for given in (north, equator)]))
line(north, shown(*(values[0] for values in together)))
PYTHON

cat > "$folder/expected" <<'EXPECTED'
52.000000 10.000000 500.0 | 52.000000 10.000000 500.0 | 52.000000 10.000000 500.0
0.000000 10.000000 500.0 | nan 10.000000 500.0 | 0.000000 10.000000 500.0
89.000000 10.000000 10000.0 | 89.000000 10.000000 10000.0 | 89.000000 10.000000 10000.0
89.999900 10.000000 10000.0 | 89.999900 10.000000 10067.4 | 89.999900 10.000000 10000.0
-89.999900 10.000000 10000.0 | -89.999900 10.000000 10067.4 | -89.999900 10.000000 10000.0
52.000000 10.000000 500.0 | 52.000000 10.000000 502.1 | 52.000000 10.000000 500.0
EXPECTED
"$folder/venv/bin/python" "$folder/positions.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
