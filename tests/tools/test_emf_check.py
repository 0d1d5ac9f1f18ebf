"""The checker asks real EMF where that is installed, and says what to install where it is not."""

import json
from pathlib import Path

import emf_check
import pytest
from sweeps import sweep

CASES = Path(__file__).resolve().parents[1] / "model" / "emf"
VERDICTS = json.loads((CASES / "verdicts.json").read_text(encoding="utf-8"))


@pytest.mark.needs("emf")
@pytest.mark.parametrize(
    "case",
    sweep(["bad_too_few", "bad_pattern", "bad_doctype", "good_values", "bad_too_many"], every=5),
)
def test_emf_says_what_is_recorded(case):
    name = f"zoo/{case}.xmi"
    done = emf_check.ask("--dump", "zoo.ecore", name, cwd=CASES)
    recorded = VERDICTS[name]
    lines = [f"OBJECT {object_line}" for object_line in recorded.get("objects", [])]
    assert done.stdout.splitlines() == [*recorded["messages"], *lines]
    assert done.returncode == (recorded["verdict"] == "error")


@pytest.mark.slow
@pytest.mark.needs("emf")
def test_what_is_saved_again_is_judged_as_before(tmp_path):
    for name in ("zoo.ecore", "zoo/good_href.xmi"):
        (tmp_path / Path(name).name).write_bytes((CASES / name).read_bytes())
    model = tmp_path / "good_href.xmi"
    (tmp_path / "parts").symlink_to(CASES / "zoo" / "parts")
    saved = tmp_path / "saved.xmi"
    assert emf_check.ask("--resave", saved, tmp_path / "zoo.ecore", model).returncode == 0
    assert emf_check.ask(tmp_path / "zoo.ecore", saved).stdout == ""


@pytest.mark.needs("emf")
def test_a_call_without_files_is_answered_with_the_usage():
    done = emf_check.ask("--dump")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("usage: ")


def test_absent_packages_are_named(monkeypatch, capsys):
    monkeypatch.setattr(emf_check, "PACKAGES", {Path("/nowhere/emf.jar"): "libemf-java"})
    assert "apt-get install --no-install-recommends libemf-java" in emf_check.missing()
    assert emf_check.main() == 3
    assert "libemf-java" in capsys.readouterr().err
