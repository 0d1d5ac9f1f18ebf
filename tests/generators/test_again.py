"""Files that are kept of a large model are those that rendering it anew would make."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import replace
from functools import partial
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest
from sweeps import sweep

from jausml.generation import generate, load_targets, render, render_again, select
from jausml.generation import rendering as again
from jausml.language.model import cache
from jausml.language.validation.engine import check_project

MODELS = Path(__file__).parents[2] / "models"
CAR = MODELS / "examples" / "catvehicle" / "catvehicle.ros2jaus"
HOW = "as it is"


@pytest.fixture(autouse=True)
def folders(tmp_path, monkeypatch):
    """The cache of this test alone, in which files of all models are kept."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setattr(again, "LARGE", 0)
    return tmp_path


@pytest.fixture
def rendered(monkeypatch):
    """How often something was rendered."""
    seen = []

    def noted(model, targets):
        seen.append(len(targets))
        return render(model, targets)

    monkeypatch.setattr(again, "render", noted)
    return seen


@pytest.fixture
def car(tmp_path):
    """A model that can be edited."""
    path = tmp_path / "model" / CAR.name
    path.parent.mkdir()
    shutil.copy(CAR, path)
    return path


def targets():
    return select(load_targets(), ["bridge", "jaus_component", "messages"]).targets


def model_of(path):
    return check_project([path]).model


@pytest.mark.parametrize(
    "name", sweep(["catvehicle/catvehicle.xmi", "examples/fleet/fleet.ros2jaus"], every=2)
)
def test_what_is_kept_is_what_was_rendered(name, rendered):
    every = select(load_targets()).targets
    expected = render(model_of(MODELS / name), every)

    assert render_again(model_of(MODELS / name), every, HOW) == expected
    assert render_again(model_of(MODELS / name), every, HOW) == expected
    assert len(rendered) == 1
    assert any(each.contract and each.contract.methods for each in expected)


@pytest.mark.slow
def test_each_thing_that_files_are_made_of_counts(car, rendered, monkeypatch):
    def makes(expected, *, only=targets, reading=HOW):
        render_again(model_of(car), only(), reading)
        render_again(model_of(car), only(), reading)
        assert rendered == [each for each in [expected] if each]
        rendered.clear()

    monkeypatch.setattr(again, "tool", cache.tool.__wrapped__)  # as another process reads it
    every = len(targets())
    makes(every)
    makes(0)
    makes(every, reading="with --frequency 5")
    makes(1, only=lambda: select(load_targets(), ["messages"]).targets)
    makes(every)
    car.write_bytes(car.read_bytes() + b"\n")
    makes(every)
    monkeypatch.setattr(cache, "__version__", "0.0")
    makes(every)
    template = cache.files("jausml_generators") / "bridge" / "templates" / "base.py.j2"
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + b"\n" * (path == template))
    makes(every)


def test_files_of_small_models_and_of_targets_of_others_are_not_kept(car, rendered, monkeypatch):
    (messages,) = select(load_targets(), ["messages"]).targets
    for chosen, large in (
        (replace(messages, tasks=partial(messages.tasks)), 0),
        (messages, 1 << 18),
    ):
        monkeypatch.setattr(again, "LARGE", large)
        render_again(model_of(car), [chosen], HOW)
        render_again(model_of(car), [chosen], HOW)
    assert rendered == [1, 1, 1, 1]


def test_what_cannot_be_told_apart_is_rendered(car, rendered, monkeypatch):
    def unknown(_):
        raise PackageNotFoundError

    monkeypatch.setattr(again, "tool", cache.tool.__wrapped__)
    monkeypatch.setattr(cache, "version", unknown)
    (messages,) = select(load_targets(), ["messages"]).targets
    assert render_again(model_of(car), [messages], HOW) == render(model_of(car), [messages])
    render_again(model_of(car), [messages], HOW)
    assert rendered == [1, 1]


def tree(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def outcome(model, folder, rendering):
    result = generate(model, targets(), folder, rendering=rendering)
    actions = [(each.kind, each.path, each.reason) for each in result.plan.actions]
    return actions, result.drift, tree(folder)


def edited(path, old, new):
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.slow
def test_each_edit_has_the_outcome_that_it_has_without_a_cache(car, tmp_path, rendered):
    """Edits of the model, of generated files and of the user's, in turn and back."""
    kept, anew = tmp_path / "kept", tmp_path / "anew"
    base = next(each.path for each in render(model_of(car), targets()) if "_base.py" in each.path)
    own = base.replace("_base.py", ".py")
    edits = [
        lambda _: None,
        lambda _: None,
        lambda _: edited(car, "operator_control_unit", "operator"),
        lambda _: edited(car, "component operator {", "component operator { fixedSources: true"),
        lambda out: (out / own).write_text(
            (out / own).read_text("utf-8") + "\nfrom json import none\n"
        ),
        lambda out: (out / own).write_text("def wrong(:\n"),
        lambda out: (out / own).unlink(),
        lambda out: (out / base).unlink(),
        lambda out: (out / base).write_text("# edited by hand\n"),
        lambda out: (out / ".jausml" / "manifest.json").unlink(),
        lambda out: (out / base).unlink(),
        shutil.rmtree,
        lambda _: None,
    ]
    for number, edit in enumerate(edits):
        model_before = car.read_bytes()
        for out, rendering in (
            (kept, lambda model, chosen: render_again(model, chosen, HOW)),
            (anew, render),
        ):
            car.write_bytes(model_before)
            edit(out)
            found = outcome(model_of(car), out, rendering)
            if out == kept:
                expected = found
        assert found == expected, number
    # The model had three states, and each was rendered once.
    assert len(rendered) == 3


@pytest.mark.slow
def test_a_kept_file_that_somebody_has_changed_is_not_written(car, tmp_path, rendered):
    generate(
        model_of(car), targets(), tmp_path / "out",
        rendering=lambda model, chosen: render_again(model, chosen, HOW),
    )  # fmt: skip
    (file,) = (tmp_path / "cache" / "jausml").iterdir()
    data = file.read_bytes()
    file.write_bytes(data[:-9] + bytes(9))
    assert render_again(model_of(car), targets(), HOW) == render(model_of(car), targets())
    assert len(rendered) == 2


@pytest.mark.slow
def test_the_verb_keeps_files_of_a_large_model_and_looks_anew_where_that_is_asked(tmp_path):
    large = tmp_path / "large.ros2jaus"
    large.write_text(f"{CAR.read_text('utf-8')}\n// {'x' * (1 << 18)}\n", encoding="utf-8")
    kept = tmp_path / "cache" / "jausml"

    def run(*options):
        command = [sys.executable, "-m", "jausml", "generate", str(large), "-o", "out", *options]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    assert run("--check").returncode == 1
    assert run("--no-cache").returncode == 0
    assert not kept.exists()
    assert run().returncode == 0
    (file,) = kept.glob("artifacts-*")
    before = tree(tmp_path / "out")
    shutil.rmtree(tmp_path / "out")
    assert run().returncode == 0
    assert tree(tmp_path / "out") == before
    assert run("--check").returncode == 0
    file.unlink()
    assert run("--no-cache").returncode == run("--check").returncode == 0
    assert not list(kept.glob("artifacts-*"))
