"""Asks the real Eclipse EMF about every metamodel and model, and records what it says.

With the verdicts and re-saved models under tests/emf/, and the verdicts on the small cases under
tests/model/emf/, the tests hold the project to EMF's judgement without Java.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypedDict

import emf_check

ROOT = Path(__file__).resolve().parent.parent
METAMODELS = [ROOT / "metamodels" / f"{name}.ecore" for name in ("jaus", "ros", "bridge", "system")]
MODELS = ROOT / "models"
RECORD = ROOT / "tests" / "emf"
CASES = ROOT / "tests" / "model" / "emf"


class Verdict(TypedDict):
    """What EMF says about a file."""

    sha256: str
    lines: list[str]


def models() -> list[Path]:
    """Every model that the project ships, in a stable order."""
    return sorted(MODELS.rglob("*.xmi"))


def examples() -> list[Path]:
    """The shipped models that are not part of the library."""
    return [path for path in models() if MODELS / "library" not in path.parents]


def digest(path: Path) -> str:
    """SHA-256 of a file, which ties a verdict to what was judged."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write(path: Path, verdicts: object) -> None:
    """Writes verdicts in an order of their own."""
    text = json.dumps(verdicts, indent=2, sort_keys=True, ensure_ascii=False)
    path.write_text(text + "\n", encoding="utf-8")


def judge(path: Path) -> Verdict:
    """What EMF says about a metamodel or model of the project, and the digest of the file."""
    files = METAMODELS if path.suffix == ".ecore" else [*METAMODELS, path]
    lines = emf_check.ask(*files, cwd=ROOT).stdout.splitlines()
    return {"sha256": digest(path), "lines": lines}


def resave(path: Path) -> None:
    """Lets EMF load and save an example among copies of all models, so that hrefs stay."""
    place = path.relative_to(MODELS)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "models"
        shutil.copytree(MODELS, copy)
        saved = (copy / place).with_suffix(".saved.xmi")
        emf_check.ask("--resave", saved, *METAMODELS, copy / place)
        kept = RECORD / "resaved" / place
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(saved, kept)


def judge_case(case: Path) -> dict[str, object]:
    """EMF's verdict on a small case, its messages, and the objects of a case that it accepts."""
    ecores = [CASES / "zoo.ecore"] if case.parent.name == "zoo" else METAMODELS
    try:
        done = emf_check.ask("--dump", *ecores, case.relative_to(CASES), cwd=CASES)
    except subprocess.TimeoutExpired:
        return {"verdict": "error", "messages": ["EMF does not end"]}
    # Neither where the checkout lies nor the identity of a Java object is a fact about the case.
    text = re.sub(
        "@[0-9a-f]{5,8}", "", done.stdout.replace(str(CASES), ".").replace(f"{ROOT}/", "")
    )
    lines = text.splitlines()
    said: dict[str, object] = {"verdict": "error" if done.returncode else "ok"}
    said["messages"] = [line for line in lines if not line.startswith("OBJECT ")]
    if not done.returncode:
        said["objects"] = [line.removeprefix("OBJECT ") for line in lines if line.startswith("OBJ")]
    return said


def record_project() -> int:
    """Records verdicts on what the project ships, and re-saved examples; returns the errors."""
    verdicts: dict[str, Verdict] = {}
    for path in [*METAMODELS, *models()]:
        name = path.relative_to(ROOT).as_posix()
        verdicts[name] = judge(path)
        for line in verdicts[name]["lines"]:
            print(line)
    write(RECORD / "verdicts.json", verdicts)
    for path in examples():
        resave(path)
    return sum(
        line.startswith("ERROR") for verdict in verdicts.values() for line in verdict["lines"]
    )


def record_cases() -> None:
    """Records the verdicts on the small cases."""
    cases = sorted([*CASES.glob("zoo/*.xmi"), *CASES.glob("shipped/*.xmi")])
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        said = pool.map(judge_case, cases)
        names = [case.relative_to(CASES).as_posix() for case in cases]
        write(CASES / "verdicts.json", dict(zip(names, said, strict=True)))


def main() -> int:
    """Command line entry."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    if emf_check.missing():
        sys.exit(emf_check.missing())
    errors = record_project()
    record_cases()
    print(f"{errors} errors")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
