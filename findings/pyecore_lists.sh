#!/bin/sh
# pyecore 0.15.2: some ways to change a list of a model leave the rest of the model as it was.
#
# - `discard` takes an element out of a containment reference, but the element still says that it
#   is contained there, and observers hear nothing. `remove` does both.
# - `del list[0]` on a feature with unique="false" is heard by nobody, and an opposite keeps its end;
#   `reverse` and `sort` are not heard either. `pop(0)` is heard, and clears the opposite.
# - `list[0] = value` there is told as ADD alone, so who counts has one too many, and what is replaced
#   keeps its end too. A slice does both rightly.
# - On a unique feature (the default) `list[0] = list[1]` makes the list one shorter.
# - To append what is there already changes nothing, and is told as ADD.
#
# Seen: the lines below EXPECTED: act, length before and after, what observers hear, and whether
# what has left still knows its owner.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pyecore==0.15.2

cat > "$folder/lists.py" <<'PYTHON'
from pyecore.ecore import EClass, EReference
from pyecore.notification import EObserver

Robot, Part = EClass("Robot"), EClass("Part")
Robot.eStructuralFeatures.append(EReference("parts", Part, upper=-1, containment=True))
lent = EReference("lent", Part, upper=-1, unique=False)
Robot.eStructuralFeatures.append(lent)
Part.eStructuralFeatures.append(EReference("borrower", Robot, eOpposite=lent))

ACTS = (
    ("parts", "remove", lambda parts: parts.remove(parts[0])),
    ("parts", "discard", lambda parts: parts.discard(parts[0])),
    ("parts", "[0] = [1]", lambda parts: parts.__setitem__(0, parts[1])),
    ("parts", "append again", lambda parts: parts.append(parts[0])),
    ("lent", "pop(0)", lambda parts: parts.pop(0)),
    ("lent", "del [0]", lambda parts: parts.__delitem__(0)),
    ("lent", "[0] = new", lambda parts: parts.__setitem__(0, Part())),
    ("lent", "[0:1] = new", lambda parts: parts.__setitem__(slice(0, 1), [Part()])),
    ("lent", "reverse", lambda parts: parts.reverse()),
)
for feature, name, act in ACTS:
    robot = Robot()
    parts = getattr(robot, feature)
    parts.extend([Part(), Part(), Part()])
    before, heard = list(parts), []
    EObserver(robot, notifyChanged=lambda change: heard.append(change.kind.name))
    act(parts)
    left = [part for part in before if part not in list(parts)]
    owners = [part.eContainer() if feature == "parts" else part.borrower for part in left]
    known = ["knows it" if owner is robot else "knows none" for owner in owners]
    print(f"{feature} {name}", len(before), len(parts), heard, *known, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
parts remove | 3 | 2 | ['REMOVE'] | knows none
parts discard | 3 | 2 | [] | knows it
parts [0] = [1] | 3 | 2 | ['REMOVE', 'ADD'] | knows none
parts append again | 3 | 3 | ['ADD']
lent pop(0) | 3 | 2 | ['REMOVE'] | knows none
lent del [0] | 3 | 2 | [] | knows it
lent [0] = new | 3 | 3 | ['ADD'] | knows it
lent [0:1] = new | 3 | 3 | ['REMOVE', 'ADD'] | knows none
lent reverse | 3 | 3 | []
EXPECTED
"$folder/venv/bin/python" "$folder/lists.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
