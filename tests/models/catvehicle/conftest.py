"""Makes the example's package and this folder's helper importable."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
for folder in (HERE, HERE.parents[2] / "models" / "catvehicle" / "src" / "catvehicle"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
