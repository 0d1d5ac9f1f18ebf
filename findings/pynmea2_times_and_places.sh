#!/bin/sh
# pynmea2 1.19.0: sentences of NMEA 0183 that are valid give wrong times and places, or other types.
#
# - ZDA, the local zone: its minutes have the sign of its hours, and are added without one. The zone
#   -03:30 becomes -02:30, and -00:30 becomes +00:30: an hour off.
# - RMC in a leap second (60 s): `timestamp` is the text of the field, and not a time; `datetime`
#   raises TypeError, though the date is there.
# - GGA and RMC without a fix have empty places: `latitude` and `longitude` are 0.0, a place in the
#   Gulf of Guinea, and no error or None.
# - The type of a number depends on the sentence: the altitude is a float in GGA and a text in GNS,
#   the heading a Decimal in HDG, the rate of turn a text in ROT.
#
# Seen: the lines below EXPECTED: a sentence, and what is read of it.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pynmea2==1.19.0

cat > "$folder/sentences.py" <<'PYTHON'
import pynmea2


def show(sentence, *names):
    message = pynmea2.parse(sentence)
    values = []
    for name in names:
        try:
            values.append(repr(getattr(message, name)))
        except TypeError as error:
            values.append(type(error).__name__)
    print(sentence, *values, sep=" | ")


for zone in ("03,30", "-03,30", "-00,30"):
    sentence = f"$GPZDA,201530.00,04,07,2002,{zone}"
    offset = pynmea2.parse(sentence).tzinfo.utcoffset(None)
    print(sentence, offset.total_seconds() / 3600, sep=" | ")
show("$GPRMC,235959.00,A,3751.65,S,14507.36,E,0,0,311216,,", "timestamp", "datetime")
show("$GPRMC,235960.00,A,3751.65,S,14507.36,E,0,0,311216,,", "timestamp", "datetime")
show("$GPRMC,081836.00,V,,,,,,,130918,,", "latitude", "longitude")
show("$GPGGA,123519,,,,,0,00,,,M,,M,,", "latitude", "longitude", "altitude")
show("$GNGGA,001043.00,4404.14,N,12118.86,W,1,12,0.98,1113.0,M,-21.3,M,,", "altitude")
show("$GNGNS,001043.00,4404.14,N,12118.86,W,AA,12,0.98,1113.0,-21.3,,", "altitude")
show("$HCHDG,101.1,,,7.1,W", "heading")
show("$TIROT,-3.5,A", "rate_of_turn")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
$GPZDA,201530.00,04,07,2002,03,30 | 3.5
$GPZDA,201530.00,04,07,2002,-03,30 | -2.5
$GPZDA,201530.00,04,07,2002,-00,30 | 0.5
$GPRMC,235959.00,A,3751.65,S,14507.36,E,0,0,311216,, | datetime.time(23, 59, 59, tzinfo=datetime.timezone.utc) | datetime.datetime(2016, 12, 31, 23, 59, 59, tzinfo=datetime.timezone.utc)
$GPRMC,235960.00,A,3751.65,S,14507.36,E,0,0,311216,, | '235960.00' | TypeError
$GPRMC,081836.00,V,,,,,,,130918,, | 0.0 | 0.0
$GPGGA,123519,,,,,0,00,,,M,,M,, | 0.0 | 0.0 | None
$GNGGA,001043.00,4404.14,N,12118.86,W,1,12,0.98,1113.0,M,-21.3,M,, | 1113.0
$GNGNS,001043.00,4404.14,N,12118.86,W,AA,12,0.98,1113.0,-21.3,, | '1113.0'
$HCHDG,101.1,,,7.1,W | Decimal('101.1')
$TIROT,-3.5,A | '-3.5'
EXPECTED
"$folder/venv/bin/python" "$folder/sentences.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
