"""Components with modelled state machines: base, skeleton, its drift, and generated tests."""

import re
from pathlib import Path

import pytest
import warm
from codec_support import ROOT
from for_each import for_each
from generated import STRICT, model_of, run_in, texts_of
from scripts import succeeded
from sweeps import sweep
from workspaces import kept, packages_of

from jausml.language.attributes.guards import parse_guard
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.modelled import ModelledComponent
from jausml.runtime.component.process import create_transport
from jausml_generators.jaus_component.machine_views import guard_text
from jausml_generators.jaus_component.machines import COMPONENT_NAMES, STANDARD_GUARDS
from jausml_generators.jaus_component.target import TARGET
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

MODEL = Path(__file__).parent / "lamp.xmi"
BASE = "spot/spot/spot_base.py"
SKELETON = "spot/spot/spot.py"


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    return texts_of(model_of(MODEL), [TARGET])


@pytest.fixture(scope="module")
def workspace() -> Path:
    return kept(model_of(MODEL), [TARGET, MESSAGES, RUNTIME])


def jausml(*arguments: str | Path) -> str:
    done = succeeded([*warm.command(), *map(str, arguments)], timeout=60)
    return done.stdout + done.stderr


def flat(text: str) -> str:
    return re.sub(r",? ([)\]])", r"\1", " ".join(text.split())).replace("( ", "(")


def test_the_model_is_valid():
    # Only what a hand-made model of every kind cannot do without.
    said = jausml("validate", MODEL)
    assert "error" not in said


def test_ruff_finds_nothing(workspace):
    config = ["--config", str(ROOT / "pyproject.toml")]
    folder = workspace / "spot"
    run_in(workspace, "-m", "ruff", "format", "--check", *config, ".", cwd=folder)
    ignore = ["--ignore", "S101,TC001,TC002,TC003"]
    run_in(workspace, "-m", "ruff", "check", *config, *ignore, ".", cwd=folder)


@pytest.mark.slow
def test_mypy_finds_nothing(workspace):
    modules = ("spot/spot", "spot/test/test_spot.py")
    run_in(workspace, "-m", "mypy", *STRICT, "--explicit-package-bases", *modules)


def test_generated_tests_drive_the_machines(workspace):
    folder = workspace / "spot"
    run_in(workspace, "-m", "pytest", "-q", "-W", "error", "test", cwd=folder)
    assert "def test_lamp_fsm_goes_as_modelled" in (folder / "test/test_spot.py").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("right", "wrong", "failure"),
    sweep(
        [
            ('target="On.Bright"', 'target="On.Dim"', "'On.Dim' == 'On.Bright'"),
            ("kind=Kind.PUSH", "kind=Kind.SIMPLE", "== 'On.Dim'"),
            ("exit=(self.import_,),", "", "== \\('import_',"),
            ("do=(self.stop_,), ", "", "== \\('"),
        ],
        every=4,
    ),
)
def test_a_wrong_base_fails_the_generated_tests(workspace, tmp_path, right, wrong, failure):
    """The ways are worked out from the model, not from the table that they test."""
    folder = tmp_path / "spot"
    for name in ("spot/spot_base.py", "spot/spot.py", "spot/messages.py", "spot/__init__.py"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        text = (workspace / "spot" / name).read_text("utf-8")
        (folder / name).write_text(text.replace(right, wrong), "utf-8")
    test = (workspace / "spot/test/test_spot.py").read_text("utf-8")
    (folder / "test_spot.py").write_text(test, "utf-8")
    for package in packages_of(workspace):
        if not (tmp_path / Path(package).name).exists():
            (tmp_path / Path(package).name).symlink_to(package)
    with pytest.raises(AssertionError, match=failure):
        # With the values, by which the mistake is told.
        run_in(tmp_path, "-m", "pytest", "-q", "--assert=rewrite", "test_spot.py", cwd=folder)


def test_machines_along_inheritance_are_one(texts):
    base = flat(texts[BASE])
    assert base.count("self.add_machine(") == 2
    machine = 'self.add_machine("LampFSM", self._lamp_fsm(), service="urn:example:Spot")'
    assert f"self.lamp_fsm = {machine}" in base
    assert 'State("On.Turning", transitions=(On("Turned", target="On.Dim"),))' in base


def test_states_of_older_service_sets_are_those_of_the_core(texts):
    base = flat(texts[BASE])
    assert 'State("Receiving.Ready.Controlled.Available.Ready", exit=(self.switch_off,)' in base
    assert 'target="Receiving.Ready.Controlled.Available.Standby"' in base


def test_messages_go_to_machines_or_to_handlers(texts):
    base = flat(texts[BASE])
    assert "self.handle_by_machines(ToggleLamp, when=Guard.READY)" in base
    assert "self.provide_by_machines(QueryLamp, ReportLamp, self.report_lamp)" in base
    # A transition for anything takes what no transition names.
    assert "self.handle_by_machines(DimLamp, when=Guard.READY)" in base
    assert "self.handle(" not in base


def test_guards_are_methods_and_never_code(texts):
    base = flat(texts[BASE])
    assert (
        "when=any_of(self.is_bright, all_of(self.is_warm,"
        " negation(any_of(self.is_old, self.class_))))" in base
    )
    assert "self.__class__" not in base


def test_parameters_are_what_the_triggers_bring(texts):
    base = flat(texts[BASE])
    assert "def is_bright(self, message: SetLamp, sender: JausAddress) -> bool:" in base
    assert "def may_turn(self, message: TurnSpot, sender: JausAddress) -> bool:" in base
    assert (
        "def is_old(self, message: SetLamp | None = None, sender: JausAddress | None = None)"
        " -> bool:" in base
    )
    assert "def switch_off(self) -> None:" in base
    assert "def tell(self) -> ReportLamp | None:" in base
    assert (
        "def anything(self, message: Message | None = None, sender: JausAddress | None = None)"
        " -> None:" in base
    )


def test_names_that_are_taken_are_changed(texts):
    base = texts[BASE]
    assert "def stop_(self, " in base.replace("\n        ", "")
    assert "def import_(" in base
    assert "def stop(" not in base
    assert "def raise_class_(self)" in base
    assert 'self.raise_event("class")' in base


def test_every_name_of_the_component_is_taken():
    settings = TransportSettings()
    with Loop() as loop:
        component = ModelledComponent(
            create_transport(settings, loop), JausAddress(1, 1, 1), name="x", services=()
        )
        names = {name for name in dir(component) if not name.startswith(("_", "on_"))}
    # Methods that answer queries may be named report_..., and leave this one out by themselves.
    assert names - COMPONENT_NAMES == {"report_changed"}
    assert set(STANDARD_GUARDS.values()) <= COMPONENT_NAMES


@pytest.mark.slow
def test_drift_tells_new_and_former_methods(tmp_path):
    model = tmp_path / "lamp.xmi"
    text = MODEL.read_text("utf-8")
    model.write_text(text, "utf-8")
    out = tmp_path / "ws"
    jausml("generate", model, "-o", out)
    assert "does not define" not in jausml("generate", model, "-o", out)
    model.write_text(
        text.replace('"switchOff"', '"darken"').replace("isBright(", "isHot("), "utf-8"
    )
    said = jausml("generate", model, "-o", out)
    for name in ("darken", "is_hot"):
        assert f"does not define {name}(" in said
    for name in ("switch_off", "is_bright"):
        assert f"{name}: the model has no such element any more" in said
    model.write_text(text.replace('"switchOff"', '"switchItOff"'), "utf-8")
    again = tmp_path / "again"
    jausml("generate", model, "-o", again)
    model.write_text(text, "utf-8")
    assert "switch_it_off: renamed to switch_off?" in jausml("generate", model, "-o", again)


def test_the_diagram_shows_states_and_transitions(texts):
    shown = texts["spot/states.md"]
    assert "stateDiagram-v2" in shown
    assert 'state "Turning" as' in shown
    assert "SetLamp [isBright || isWarm && !(isOld || __class__)] / import" in shown
    assert shown.count("```mermaid") == 2


@for_each("text", ["a", "!a", "a && b || c", "a && (b || !c)", "!(a && b) || d"])
def test_guard_text_is_read_back_the_same(text):
    guard = parse_guard(text)
    assert parse_guard(guard_text(guard)) == guard
