#!/bin/sh
# takproto 3.0.1: an event of Cursor on Target that becomes TAK protocol loses what has no field.
#
# A message of the protocol has fields for some elements below `detail` (contact, __group, status,
# track, ...), and `xmlDetail` for whatever else stands there. Of an element that has more than its
# fields, `xml2proto` takes the fields and drops the rest, without a word:
# - the phone of a contact, the slope of a track, whether somebody is ready, the role of a team;
# - elements within such an element;
# - a status without a battery disappears as a whole.
# Remarks and links, which have no field at all, stay as they are.
# A time with an offset from UTC, which the schema allows, is refused (ValueError).
#
# Seen: the lines below EXPECTED: the element, and the detail of the message that is read again.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet protobuf==7.36.2 takproto==3.0.1

cat > "$folder/attributes.py" <<'PYTHON'
import json

from google.protobuf.json_format import MessageToDict
from takproto import parse_proto, xml2proto

EVENT = """<event version="2.0" uid="ugv-1" type="a-f-G-U-C" how="m-g"
  time="2026-01-02T03:04:05{zone}" start="2026-01-02T03:04:05Z" stale="2026-01-02T03:09:05Z">
<point lat="48.1" lon="11.5" hae="10" ce="5" le="5"/><detail>{detail}</detail></event>"""


def written(detail, zone="Z"):
    message = parse_proto(xml2proto(EVENT.format(detail=detail, zone=zone)))
    return json.dumps(MessageToDict(message.cotEvent.detail))


for detail in (
    '<track speed="1.5" course="350.5"/>',
    '<track speed="1.5" course="350.5" slope="2.0"/>',
    '<contact callsign="A" phone="123"/>',
    '<contact callsign="A"><radio channel="7"/></contact>',
    '<status battery="55" readiness="true"/>',
    '<status readiness="true"/>',
    '<__group name="Cyan" role="Team Member" exrole="medic"/>',
    "<remarks>a</remarks>",
):
    print(detail, written(detail), sep=" | ")
try:
    written("", "+02:00")
except ValueError:
    print("+02:00", "ValueError", sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
<track speed="1.5" course="350.5"/> | {"track": {"speed": 1.5, "course": 350.5}}
<track speed="1.5" course="350.5" slope="2.0"/> | {"track": {"speed": 1.5, "course": 350.5}}
<contact callsign="A" phone="123"/> | {"contact": {"callsign": "A"}}
<contact callsign="A"><radio channel="7"/></contact> | {"contact": {"callsign": "A"}}
<status battery="55" readiness="true"/> | {"status": {"battery": 55}}
<status readiness="true"/> | {}
<__group name="Cyan" role="Team Member" exrole="medic"/> | {"group": {"name": "Cyan", "role": "Team Member"}}
<remarks>a</remarks> | {"xmlDetail": "<remarks>a</remarks>"}
+02:00 | ValueError
EXPECTED
"$folder/venv/bin/python" "$folder/attributes.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
