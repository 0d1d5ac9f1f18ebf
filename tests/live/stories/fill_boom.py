"""What the user writes into the skeleton of the boom: a motor that says what it does."""

import sys
from pathlib import Path

MOTOR = """        with open("motor.log", "a", encoding="utf-8") as log:
            log.write("{}\\n")
"""
CHANGES = {
    "        return super().report_boom(message, sender)\n": (
        '        is_folded = self.folding.state == "Folded"\n'
        "        State = ReportBoom.State\n"
        "        return ReportBoom(state=State.FOLDED if is_folded else State.MOVING)\n"
    ),
    "        super().start_motor()\n": MOTOR.format("start"),
    "        super().stop_motor()\n": MOTOR.format("stop"),
}

path = Path(sys.argv[1])
text = path.read_text(encoding="utf-8")
for old, new in CHANGES.items():
    if old not in text:
        sys.exit(f"{path} has no {old.strip()}")
    text = text.replace(old, new)
path.write_text(text, encoding="utf-8")
