"""A service in JSIDL, all the way: imported, generated, clean, and the package's own tests pass."""

from pathlib import Path

import pytest
import warm
from codec_support import ROOT
from generated import STRICT, run_in
from scripts import succeeded

JSIDL = ROOT / "tests" / "importers" / "winch"
SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:system="http://www.jausml.org/system/1.0" name="imported">
  <components name="hoist" address="1.1.1">
    <provides href="services.xmi#Winch"/>
  </components>
</system:System>
"""


def jausml(*arguments: str | Path) -> str:
    done = succeeded([*warm.command(), *map(str, arguments)], timeout=110)
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("imported")
    jausml("import", "jsidl", JSIDL, "-o", folder / "services.xmi")
    (folder / "system.xmi").write_text(SYSTEM, encoding="utf-8")
    jausml("generate", folder / "system.xmi", "-o", folder, "--quiet")
    return folder


def test_the_machine_of_the_service_is_generated(workspace):
    base = (workspace / "hoist/hoist/hoist_base.py").read_text(encoding="utf-8")
    assert "self.add_machine(" in base
    assert "self.handle_by_machines(" in base


@pytest.mark.slow
def test_the_package_is_clean(workspace):
    config = ["--config", ROOT / "pyproject.toml", "--no-cache"]
    run_in(workspace, "-m", "ruff", "format", "--check", *config, "hoist")
    # Here the runtime stands beside the package; where that is built, it is installed.
    installed = ["--config", "lint.isort.known-third-party = ['jausml_runtime']"]
    # A skeleton imports what its user will need, and tests assert.
    ignored = ["--ignore", "S101,TC001,TC002,TC003"]
    run_in(workspace, "-m", "ruff", "check", *config, *installed, *ignored, "hoist")
    run_in(workspace, "-m", "mypy", *STRICT, "-p", "hoist")


@pytest.mark.slow
def test_the_tests_of_the_package_pass(workspace):
    done = run_in(workspace, "-m", "pytest", "-q", "-W", "error", "hoist/test")
    assert " passed" in done


BALER = """<?xml version="1.0" encoding="UTF-8"?>
<service_def xmlns="urn:jaus:jsidl:1.1" name="Baler" id="urn:example:farm:Baler" version="1.0">
  <description>Bales, and ejects what is baled.</description>
  <assumptions/>
  <references>
    <inherits_from name="accessControl" id="urn:jaus:jss:core:AccessControl" version="1.1"/>
  </references>
  <message_set>
    <input_set>
      <message_def name="SetBaling" message_id="D110" is_command="true">
        <body name="Body"/>
      </message_def>
    </input_set>
    <output_set/>
  </message_set>
  <internal_events_set>
    <event_def name="Full"/>
    <event_def name="Ejected"/>
  </internal_events_set>
  <protocol_behavior is_stateless="false">
    <start state_machine_name="accessControl.events.transport.ReceiveFSM"
        state_name="Receiving.Ready.NotControlled.Available"/>
    <state_machine name="accessControl.events.transport.ReceiveFSM">
      <state name="Receiving" initial_state="Ready">
        <state name="Ready" initial_state="Controlled">
          <state name="Controlled" initial_state="Available">
            <state name="Available" initial_state="Idle">
              <state name="Idle">
                <transition name="accessControl.events.transport.Receive">
                  <parameter type="SetBaling" value="msg"/>
                  <guard condition="isControllingClient(msg)"/>
                  <simple><end_state state="Receiving.Ready.Controlled.Available.Baling"/></simple>
                </transition>
              </state>
              <state name="Baling">
                <transition name="Full">
                  <push><end_state state="Receiving.Ready.Controlled.NotAvailable.Ejecting"/></push>
                  <action name="openGate"/>
                </transition>
              </state>
            </state>
            <state name="NotAvailable" initial_state="Ejecting">
              <state name="Ejecting">
                <transition name="Ejected">
                  <pop/>
                </transition>
              </state>
            </state>
          </state>
        </state>
      </state>
    </state_machine>
  </protocol_behavior>
</service_def>
"""


@pytest.mark.slow
def test_a_service_refines_the_states_of_access_control(tmp_path):
    """Where Management has further states, which the service knows nothing of."""
    (tmp_path / "Baler.xml").write_text(BALER, encoding="utf-8")
    said = jausml("import", "jsidl", tmp_path / "Baler.xml", "-o", tmp_path / "services.xmi")
    assert "error" not in said
    system = SYSTEM.replace("hoist", "baler").replace("#Winch", "#Baler")
    (tmp_path / "system.xmi").write_text(system, encoding="utf-8")
    jausml("generate", tmp_path / "system.xmi", "-o", tmp_path, "--quiet")
    base = (tmp_path / "baler/baler/baler_base.py").read_text(encoding="utf-8")
    assert 'extends="AccessControl"' in base
    test = (tmp_path / "baler/test/test_baler.py").read_text(encoding="utf-8")
    assert '"Receiving.Ready.Controlled.NotAvailable.Ejecting",' in test
    assert " passed" in run_in(tmp_path, "-m", "pytest", "-q", "-W", "error", "baler/test")
