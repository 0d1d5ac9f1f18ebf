"""Packages of JAUS components: what is in them, and that they run."""

import inspect
from functools import cache
from pathlib import Path

import pytest
from codec_support import ROOT
from generated import STRICT, model_in, model_of, run_in, text_of
from ports import free_port
from sweeps import sweep
from workspaces import kept

from jausml.generation.artifact import Artifact, Kind
from jausml.generation.rendering import render
from jausml.runtime import JausComponent
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.jaus_component.target import TARGET
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

HERE = Path(__file__).parent
MODEL = HERE / "components.xmi"
TARGETS = [TARGET, MESSAGES, RUNTIME]
PACKAGES = ["wrench_driver", "operator_jaus", "nothing_at_all"]


@cache
def artifacts() -> list[Artifact]:
    return render(model_of(MODEL), TARGETS)


def texts() -> dict[str, str]:
    return {artifact.path: artifact.text for artifact in artifacts()}


@pytest.fixture(scope="module")
def workspace() -> Path:
    return kept(model_of(MODEL), TARGETS)


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_is_an_ament_python_package(package):
    files = {path.removeprefix(f"{package}/") for path in texts() if path.startswith(f"{package}/")}
    assert files == {
        "package.xml", "setup.py", "setup.cfg", f"resource/{package}", f"{package}/__init__.py",
        f"{package}/py.typed", f"{package}/messages.py", f"{package}/{package}_base.py",
        f"{package}/{package}.py", f"{package}/main.py", f"test/test_{package}.py",
    }  # fmt: skip


def test_only_the_skeleton_is_the_users():
    skeletons = [a.path for a in artifacts() if a.kind is Kind.SKELETON]
    assert skeletons == sorted(f"{package}/{package}/{package}.py" for package in PACKAGES)


def test_messages_are_those_of_services_and_connections():
    driver = texts()["wrench_driver/wrench_driver/messages.py"]
    client = texts()["operator_jaus/operator_jaus/messages.py"]
    for name in ("SetWrenchEffort", "ReportLocalPose", "ExecuteList"):
        assert f'"{name}",' in driver
    assert '"SetElement",' not in driver
    assert '"ReportLocalPose",' in client
    assert '"ExecuteList",' not in client


def test_commands_are_obeyed_as_the_service_demands():
    base = texts()["wrench_driver/wrench_driver/wrench_driver_base.py"]
    flat = " ".join(base.split())
    assert "self.handle(SetWrenchEffort, self.on_set_wrench_effort, when=Guard.READY)" in flat
    assert "self.handle(SetLocalPose, self.on_set_local_pose, when=Guard.CONTROLLED)" in flat
    assert "self.handle(ExecuteList, self.on_execute_list, when=Guard.READY)" in flat
    for name in ("RequestControl", "SetElement", "QueryTime"):
        assert name not in flat, "the runtime handles the messages of the core services"


def test_a_silent_report_leads_to_the_state_that_the_model_says():
    flat = " ".join(texts()["operator_jaus/operator_jaus/operator_jaus_base.py"].split())
    assert "silence_timeout=0.5, on_silence=lambda: self.on_effort_silent" in flat
    assert flat.count("stands_by=True") == 1


def test_limits_of_a_velocity_command_are_obeyed_in_standby(tmp_path):
    text = "component driver { address: 1.1.1  provides: VelocityStateDriver }"
    base = text_of(model_in(tmp_path, f"import jaus.mobility\n{text}\n"), [TARGET])
    assert (
        "self.handle( SetVelocityCommand, self.on_set_velocity_command, "
        "when=lambda message: Guard.READY if message.command_type == 0 else Guard.CONTROLLED, )"
    ) in " ".join(base.split())
    compile(base, "driver_base.py", "exec")


def test_messages_without_fields_are_laid_out_too(tmp_path):
    """A module without a `struct` once had a blank line too many."""
    text = """
service Bell { urn: "urn:example:own:Bell"
  inputs: new message_def Ring { code: 0xD120  isCommand: true } }
component bell { address: 1.1.1  provides: Bell }
"""
    messages = text_of(model_in(tmp_path, text), [MESSAGES], "/bell.py")
    (tmp_path / "messages.py").write_text(messages, encoding="utf-8")
    config = ["--config", str(ROOT / "pyproject.toml"), "messages.py"]
    run_in(tmp_path, "-m", "ruff", "format", "--check", *config)
    run_in(tmp_path, "-m", "ruff", "check", *config)


def test_every_method_of_the_base_is_in_the_skeleton_and_in_its_contract():
    (skeleton,) = (a for a in artifacts() if a.path.endswith("wrench_driver/wrench_driver.py"))
    assert skeleton.contract is not None
    names = [method.name for method in skeleton.contract.methods]
    assert len(set(names)) == len(names)
    assert {"on_set_wrench_effort", "report_wrench_effort", "on_execute_list"} <= set(names)
    for method in skeleton.contract.methods:
        if not method.optional:
            assert f"    def {method.name}(" in skeleton.text
            assert method.stub in skeleton.text


def test_hooks_of_every_component_are_in_the_contract():
    """A user's `on_not_ready` was once reported as a method that nothing calls."""
    (skeleton,) = (a for a in artifacts() if a.path.endswith("wrench_driver/wrench_driver.py"))
    assert skeleton.contract is not None
    hooks = {
        method.name: method.parameters for method in skeleton.contract.methods if method.optional
    }
    own = {
        name: tuple(inspect.signature(method).parameters)[1:]
        for base in JausComponent.__mro__
        for name, method in vars(base).items()
        if name.startswith(("on_", "host_time", "supports_element"))
        and name not in {"on_message", "on_payload"}
    }
    assert hooks == own


@pytest.mark.parametrize("package", PACKAGES)
def test_ruff_finds_nothing(workspace, package):
    config = ["--config", str(ROOT / "pyproject.toml")]
    # A skeleton imports what its user will need, and tests assert.
    ignore = ["--ignore", "S101,TC001,TC002,TC003"]
    folder = workspace / package
    run_in(workspace, "-m", "ruff", "format", "--check", *config, ".", cwd=folder)
    run_in(workspace, "-m", "ruff", "check", *config, *ignore, ".", cwd=folder)


def test_one_service_and_a_long_documentation_are_laid_out(tmp_path):
    services, words = "http://www.jausml.org/library/jaus", " ".join(["documentation"] * 100)
    model = model_in(
        tmp_path,
        '<system:System xmlns:system="http://www.jausml.org/system/1.0" name="one">'
        f'<components name="clock" address="1.1.1" coreServices="none" documentation="{words}">'
        f'<provides href="{services}/core-1.1.xmi#Transport"/></components>'
        f'<bridges name="front" address="1.1.2" documentation="{words}"/></system:System>',
        "model.xmi",
    )
    for target, name in ((TARGET, "clock_base.py"), (BRIDGE, "front_base.py")):
        (tmp_path / name).write_text(text_of(model, [target]))
    assert "\nSERVICES = (Service" in (tmp_path / "clock_base.py").read_text()
    config = ["--config", str(ROOT / "pyproject.toml")]
    run_in(tmp_path, "-m", "ruff", "format", "--check", *config, ".")
    run_in(tmp_path, "-m", "ruff", "check", "--select=E,W", *config, ".")


@pytest.mark.slow
def test_mypy_finds_nothing(workspace):
    packages = [argument for package in PACKAGES for argument in ("-p", package)]
    run_in(workspace, "-m", "mypy", *STRICT, *packages)


@pytest.mark.parametrize("package", sweep(PACKAGES, every=3))
def test_generated_tests_pass(workspace, package):
    run_in(workspace, "-m", "pytest", "-q", "-W", "error", "test", cwd=workspace / package)


def test_generated_tests_tell_other_ranges_of_the_same_bytes():
    test = texts()["wrench_driver/test/test_wrench_driver.py"]
    assert '("ReportTravelSpeed", {"speed": 109.22333333333333})' in test  # a third of 327.67
    assert "for name in numbers} == pytest.approx(numbers)" in test


def test_components_exchange_commands_and_reports(workspace):
    run_in(workspace, HERE / "exchange.py", str(free_port()))


def test_the_executable_explains_itself(workspace):
    run_in(workspace, "-m", "wrench_driver.main", "--help")


LOGGER = """import `jaus.mobility`
system s {
  component vehicle { address: 100.1.1  provides: VelocityStateSensor  external: true }
  component logger {
    address: 100.1.3
    service_connection velocity {
      provider: vehicle  message: VelocityStateSensor.ReportVelocityState
      exchange: periodic  rate: 5  silenceTimeout: 1
    }
  }
}
"""


def test_a_silence_is_told_beside_reports_that_come_often(tmp_path):
    base = text_of(model_in(tmp_path, LOGGER), [TARGET], "logger_base.py")
    before, _, behind = base.partition("def on_velocity_silent")
    assert '"component.not_implemented", f"on_velocity: ' in before
    assert '"component.silence_not_implemented", f"on_velocity_silent:' in behind
