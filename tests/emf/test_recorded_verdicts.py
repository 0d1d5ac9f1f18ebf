"""Real EMF accepts the metamodels and models, and what it saves again means the same to us.

`make emf` records the verdicts and the re-saved models; these tests need no Java.
"""

import hashlib
import json
import shutil
from pathlib import Path

import pytest
import warm
from for_each import for_each
from scripts import succeeded

GUARDS = ("metamodels", "models")

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
VERDICTS = json.loads((HERE / "verdicts.json").read_text(encoding="utf-8"))
RESAVED = sorted((HERE / "resaved").rglob("*.xmi"))
# The others are documents that a system of the same folder refers to.
SYSTEMS = [path for path in RESAVED if "<system:System" in path.read_text(encoding="utf-8")]
JUDGED = [*sorted((ROOT / "metamodels").glob("*.ecore")), *sorted((ROOT / "models").rglob("*.xmi"))]


@for_each("path", JUDGED, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_emf_reports_no_error(path):
    verdict = VERDICTS[path.relative_to(ROOT).as_posix()]
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert verdict["sha256"] == digest, "changed since EMF judged it: run `make emf`"
    assert not [line for line in verdict["lines"] if line.startswith("ERROR")]


def test_every_example_was_saved_again():
    examples = [path for path in JUDGED if path.suffix == ".xmi" and "library" not in path.parts]
    saved = {path.relative_to(HERE / "resaved") for path in RESAVED}
    assert saved == {path.relative_to(ROOT / "models") for path in examples}


def generate(models: Path, place: Path, out: Path) -> dict[str, bytes]:
    """Generates a model of a models folder; returns the files by relative path."""
    model = models / place
    verb = [*warm.command(), "generate"]
    command = [*verb, str(model), "-o", str(out), "--project-root", str(models)]
    succeeded(command, timeout=100)
    return {
        path.relative_to(out).as_posix(): path.read_bytes()
        for path in sorted(out.rglob("*"))
        if path.is_file()
    }


@pytest.mark.slow
@pytest.mark.parametrize("saved", SYSTEMS, ids=lambda path: path.stem)
def test_saved_again_generates_the_same(saved, tmp_path):
    place = saved.relative_to(HERE / "resaved")
    models = tmp_path / "models"
    shutil.copytree(ROOT / "models" / "library", models / "library")
    shutil.copytree(saved.parent, (models / place).parent)
    ours = generate(ROOT / "models", place, tmp_path / "ours")
    theirs = generate(models, place, tmp_path / "theirs")
    assert ours.keys() == theirs.keys()
    assert ours == theirs


def test_there_are_systems_among_the_saved():
    assert {path.stem for path in SYSTEMS} == {"catvehicle", "jaus_only", "minimal", "winch"}
