"""Records what real EMF says about the cases beside this file.

    python tests/model/emf/record.py path/to/emf-check

emf-check is any program that takes .ecore files and a model, prints `SEVERITY file: message` lines,
prints every object when called with --dump, and ends with 1 when there was an ERROR. What is
recorded is compared with ours by tests/model/test_oracle.py, which needs neither EMF nor Java.
"""

import json
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
METAMODELS = HERE.parents[2] / "metamodels"
LANGUAGES = ("jaus", "ros", "bridge", "system")


def verdict(program: str, case: Path, ecores: list[Path]) -> dict[str, object]:
    """Runs EMF on one case."""
    names = [str(path) for path in (*ecores, case.relative_to(HERE))]
    command = [program, "--quiet", "--dump", *names]
    try:
        done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, timeout=20)
    except subprocess.TimeoutExpired:
        return {"verdict": "error", "messages": ["EMF does not end"]}
    lines = [
        re.sub("@[0-9a-f]{5,8}", "", line.replace(str(HERE), "."))
        for line in done.stdout.splitlines()
    ]
    said: dict[str, object] = {"verdict": "error" if done.returncode else "ok"}
    said["messages"] = [line for line in lines if not line.startswith("DUMP ")]
    if not done.returncode:
        said["dump"] = [line[5:] for line in lines if line.startswith("DUMP ")]
    return said


def main() -> None:
    """Writes verdicts.json."""
    shipped = [METAMODELS / f"{name}.ecore" for name in LANGUAGES]
    work = [(case, [Path("zoo.ecore")]) for case in sorted(HERE.glob("zoo/*.xmi"))]
    work += [(case, shipped) for case in sorted(HERE.glob("shipped/*.xmi"))]
    with ThreadPoolExecutor(2) as pool:
        found = pool.map(lambda item: verdict(sys.argv[1], *item), work)
        verdicts = {
            str(case.relative_to(HERE)): said for (case, _), said in zip(work, found, strict=True)
        }
    text = json.dumps(verdicts, indent=1, sort_keys=True, ensure_ascii=True)
    (HERE / "verdicts.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
