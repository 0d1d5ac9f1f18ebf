"""Asks the real Eclipse EMF about every metamodel and model, and records what it says.

The recorded verdicts and re-saved models under tests/emf/ let the tests hold the project to EMF's
judgement without Java. EMF itself is reached through a command line checker, by default the one
beside the checkout; --emf-check or the environment variable EMF_CHECK names another.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
METAMODELS = [ROOT / "metamodels" / f"{name}.ecore" for name in ("jaus", "ros", "bridge", "system")]
RECORD = ROOT / "tests" / "emf"


def models() -> list[Path]:
    """Every model that the project ships, in a stable order."""
    return sorted((ROOT / "models").rglob("*.xmi"))


def examples() -> list[Path]:
    """The shipped models that are not part of the library."""
    return [path for path in models() if (ROOT / "models" / "library") not in path.parents]


def digest(path: Path) -> str:
    """SHA-256 of a file, which ties a verdict to what was judged."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def ask(checker: str, *arguments: str) -> list[str]:
    """Runs the checker; returns its lines, made independent of where the checkout lies.

    Raises:
        SystemExit: the checker could not run (missing packages, wrong usage).
    """
    result = subprocess.run(
        [checker, "--quiet", *arguments], check=False, capture_output=True, text=True
    )
    if result.returncode not in (0, 1):
        sys.exit(f"{checker}: {result.stderr.strip() or result.stdout.strip()}")
    text = (result.stdout + result.stderr).replace(f"{ROOT}/", "")
    return [line for line in text.splitlines() if line.strip()]


def record(checker: str) -> int:
    """Writes verdicts.json and the re-saved examples; returns the number of errors."""
    metamodels = [str(path) for path in METAMODELS]
    verdicts = {}
    for path in [*METAMODELS, *models()]:
        files = metamodels if path.suffix == ".ecore" else [*metamodels, str(path)]
        lines = ask(checker, *files)
        verdicts[path.relative_to(ROOT).as_posix()] = {"sha256": digest(path), "lines": lines}
        print(f"{path.relative_to(ROOT)}: {len(lines)} messages")
    RECORD.mkdir(parents=True, exist_ok=True)
    text = json.dumps(verdicts, indent=2, sort_keys=True, ensure_ascii=False)
    (RECORD / "verdicts.json").write_text(text + "\n", encoding="utf-8")
    for path in examples():
        resave(checker, path)
    return sum(
        line.startswith("ERROR") for verdict in verdicts.values() for line in verdict["lines"]
    )


def resave(checker: str, path: Path) -> None:
    """Lets EMF load and save an example among copies of all models, so that hrefs stay."""
    place = path.relative_to(ROOT / "models")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "models"
        shutil.copytree(ROOT / "models", copy)
        target = copy / place
        saved = target.with_suffix(".saved.xmi")
        ask(checker, "--roundtrip", str(saved), *map(str, METAMODELS), str(target))
        kept = RECORD / "resaved" / place
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(saved, kept)


def main() -> int:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__)
    default = os.environ.get("EMF_CHECK", str(ROOT.parent / "shared" / "tools" / "emf-check"))
    parser.add_argument("--emf-check", default=default, help="the checker to run")
    arguments = parser.parse_args()
    if shutil.which(arguments.emf_check) is None:
        sys.exit(f"no EMF checker at {arguments.emf_check}; name one with --emf-check or EMF_CHECK")
    errors = record(arguments.emf_check)
    print(f"{errors} errors")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
