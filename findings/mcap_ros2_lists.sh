#!/bin/sh
# mcap-ros2-support 0.6.0 writes lists that are not those it was given, without a word.
#
# - A bounded sequence and an array are cut to their bound: int32[<=2] of [1, 2, 3] is [1, 2].
# - An array that is too short is filled up with zeros, and so is the list of the caller, which has
#   a None more afterwards.
# - A list whose definition states a default cannot be written at all: ValueError, whatever is
#   given. Left out, it becomes empty, not the default. Single values with a default are written,
#   and left out they become the default.
# A number that does not fit its field is refused, as all of these might be.
#
# Seen: the lines below EXPECTED: field, given, read again (or the error), the caller's list.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet mcap==1.6.0 mcap-ros2-support==0.6.0

cat > "$folder/lists.py" <<'PYTHON'
import io

from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer

CASES = (
    ("int32[<=2] field", {"field": [1, 2, 3]}),
    ("int32[2] field", {"field": [1, 2, 3]}),
    ("int32[2] field", {"field": [1]}),
    ("float64[2] field [1.0, 2.0]", {"field": [4.0, 5.0]}),
    ("float64[] field [1.0, 2.0]", {"field": [4.0]}),
    ("float64[] field [1.0, 2.0]", {}),
    ("float64 field 1.5", {"field": 4.0}),
    ("float64 field 1.5", {}),
    ("uint8 field", {"field": 300}),
)
for definition, values in CASES:
    given = {name: list(value) if isinstance(value, list) else value for name, value in values.items()}
    stream = io.BytesIO()
    writer = Writer(stream)
    schema = writer.register_msgdef("p/msg/M", definition)
    try:
        writer.write_message("/topic", schema, values, 1, 1)
        writer.finish()
        stream.seek(0)
        [message] = read_ros2_messages(stream)
        result = message.ros_msg.field
    except Exception as error:
        result = type(error).__name__
    print(definition, given, result, values.get("field"), sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
int32[<=2] field | {'field': [1, 2, 3]} | [1, 2] | [1, 2, 3]
int32[2] field | {'field': [1, 2, 3]} | [1, 2] | [1, 2, 3]
int32[2] field | {'field': [1]} | [1, 0] | [1, None]
float64[2] field [1.0, 2.0] | {'field': [4.0, 5.0]} | ValueError | [4.0, 5.0]
float64[] field [1.0, 2.0] | {'field': [4.0]} | ValueError | [4.0]
float64[] field [1.0, 2.0] | {} | [] | None
float64 field 1.5 | {'field': 4.0} | 4.0 | 4.0
float64 field 1.5 | {} | 1.5 | None
uint8 field | {'field': 300} | error | 300
EXPECTED
"$folder/venv/bin/python" "$folder/lists.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
