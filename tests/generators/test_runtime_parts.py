"""The part of the runtime that a workspace has: what its code imports, and nothing else."""

import ast
import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from threading import Barrier, BrokenBarrierError

import pytest
from for_each import for_each
from generated import model_in, model_of
from workspaces import python_path

from jausml.generation.manifest import MANIFEST_PATH
from jausml.generation.rendering import render
from jausml.generation.workspace import Result
from jausml.generation.workspace import generate as generate_code
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.python.package import FACE
from jausml_generators.runtime.modules import copied, needed, runtime_modules
from jausml_generators.runtime.target import TARGET as RUNTIME

from .node_support import run

HEAD = "import jaus.mobility\nimport mappings.velocity_state_sensor\n"
TALKER = f"{HEAD}component talker {{ address: 1.1.1  provides: VelocityStateSensor }}\n"
FRONT = f"""{HEAD}bridge front {{ address: 1.1.2  provides: VelocityStateSensor
  connection speed {{ map: velocity_state  topic odom {{}} }} }}
"""
TARGETS = (COMPONENT, BRIDGE, MESSAGES, RUNTIME)


def generate(folder: Path, text: str, name: str, targets=TARGETS, **options) -> Result:
    model = model_in(folder, text, f"{name}.ros2jaus")
    return generate_code(model, targets, folder / "src", kept=None, **options)


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """Returns what puts what is generated of a model into a folder; it is generated once."""
    known = {}

    def begin(folder, text, name):
        if text not in known:
            known[text] = tmp_path_factory.mktemp(name)
            generate(known[text], text, name)
        shutil.copytree(known[text], folder, dirs_exist_ok=True)

    return begin


def modules(folder: Path) -> set[str]:
    copy = folder / "src" / FACE / FACE
    return {path.relative_to(copy).as_posix() for path in copy.rglob("*.py")}


def starts(workspace: Path, package: str) -> None:
    done = run("-m", f"{package}.main", "--help", PYTHONPATH=python_path(workspace))
    assert done.returncode == 0, done.stderr


def test_a_component_has_no_bridge(begun, tmp_path):
    begun(tmp_path, TALKER, "talk")
    found = modules(tmp_path)
    assert "component/process.py" in found
    assert not [name for name in found if name.startswith(("bridge/", "guardian/", "virtual/"))]
    assert "rclpy" not in (tmp_path / "src" / FACE / "package.xml").read_text("utf-8")
    starts(tmp_path / "src", "talker")


def test_a_bridge_that_commands_with_a_stop_has_a_guardian(tmp_path):
    vehicle = Path(__file__).parents[2] / "models" / "catvehicle" / "catvehicle.xmi"
    generate_code(model_of(vehicle), TARGETS, tmp_path / "src", kept=None)
    assert {"bridge/guardian.py", "guardian/process.py", "guardian/ward.py"} <= modules(tmp_path)


def test_a_component_has_the_parts_that_its_model_asks_for(begun, tmp_path):
    begun(tmp_path, TALKER, "talk")
    alone = modules(tmp_path)
    assert not [name for name in alone if "list" in name or "handoff" in name]
    clients = {name for name in alone if name.startswith("clients/")}
    assert clients == {f"clients/{name}.py" for name in ("__init__", "presence", "registration")}
    assert {"transports/jtcp.py", "transports/node_manager.py"}.isdisjoint(alone)
    user = f"""{HEAD}component eye {{ address: 1.1.3  uses: VelocityStateSensor
      service_connection speed {{ provider: talker  message: ReportVelocityState  rate: 5 }} }}
    """
    generate(tmp_path, TALKER + user.removeprefix(HEAD), "talk")
    added = ("event_client", "event_stream", "event_subscriber", "event_subscription", "pace")
    added = (*added, "querier", "query")
    assert modules(tmp_path) - alone == {f"clients/{name}.py" for name in added}


@pytest.mark.parametrize(
    ("option", "word", "part"),
    [
        ("--jaus-transport", "jtcp", "JtcpTransport"),
        ("--discovery-scope", "subsystem", "Directory"),
    ],
)
def test_who_asks_for_more_than_the_model_is_told_the_word(tmp_path, option, word, part):
    # Of a subsystem with external components one of them is the server.
    boss = "component boss { address: 1.1.3  external: true  provides: VelocityStateSensor }\n"
    generate(tmp_path, TALKER.replace("1.1.1", "1.1.2") + boss, "talk")
    line = ("-m", "talker.main", option, word)
    done = run(*line, PYTHONPATH=python_path(tmp_path / "src"))
    assert done.returncode == 1
    assert f"this workspace has no {part}" in done.stderr
    assert "`jausml generate --all` brings it" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("transport", "module"), [("jtcp", "jtcp"), ("nodeManager", "node_manager")]
)
def test_a_modelled_transport_is_there(tmp_path, transport, module):
    host = f"host pc {{ transport: {transport} }}\nplacement {{ host: pc  components: talker }}\n"
    generate(tmp_path, TALKER + host, "talk")
    assert f"transports/{module}.py" in modules(tmp_path)
    starts(tmp_path / "src", "talker")


def test_a_method_of_a_part_that_the_base_has_not_is_a_finding(begun, tmp_path):
    begun(tmp_path, TALKER, "talk")
    own = tmp_path / "src" / "talker" / "talker" / "talker.py"
    text = own.read_text("utf-8")
    asking = "    def ask(self) -> None:\n        self.read_list(ADDRESS, print)\n"
    own.write_text(f"{text}\n{asking}", encoding="utf-8")
    (finding,) = generate(tmp_path, TALKER, "talk").drift
    assert "has no read_list" in finding.message
    named = text.replace("(TalkerBase)", "(ListEditor, TalkerBase)")
    named = named.replace("import ComponentSettings", "import ListEditor, ComponentSettings")
    own.write_text(f"{named}\n{asking}", encoding="utf-8")
    assert generate(tmp_path, TALKER, "talk").drift == ()
    assert "clients/list_client.py" in modules(tmp_path)
    starts(tmp_path / "src", "talker")


def test_a_bridge_has_the_kinds_of_connections_that_it_has(begun, tmp_path):
    begun(tmp_path, FRONT, "front")
    found = modules(tmp_path)
    assert "bridge/connections/to_reports.py" in found
    absent = {"to_jaus", "to_ros", "controlled_peers", "event_client", "control_session", "query"}
    absent |= {"services", "modelled", "program", "node_process", "spinning", "actions"}
    assert absent.isdisjoint(name.rpartition("/")[2].removesuffix(".py") for name in found)
    assert not [
        name for name in found if name.startswith(("bridge/lists/", "guardian/", "virtual/"))
    ]
    starts(tmp_path / "src", "front")


def test_a_bridge_has_of_conversions_what_it_names(begun, tmp_path):
    begun(tmp_path, FRONT, "front")
    found = {name for name in modules(tmp_path) if name.startswith("conversions/")}
    assert found == {f"conversions/{name}.py" for name in ("__init__", "numbers", "times", "types")}
    named = "from jausml_runtime import conversions\nprint(conversions.reverse_rows([1, 2], 1))\n"
    assert "conversions.rasters" in needed([("a.py", named)])
    for whole in (
        "from jausml_runtime import conversions as c",
        "import jausml_runtime.conversions",
    ):
        assert "conversions.rasters" in needed([("a.py", f"{whole}\n")])


def test_a_bridge_that_hears_of_handoffs_is_asked_what_a_person_decides(begun, tmp_path):
    begun(tmp_path, FRONT, "front")
    assert not {name for name in modules(tmp_path) if "handoff" in name}
    deciding = FRONT.replace(
        "provides: VelocityStateSensor", "provides: VelocityStateSensor, HandoffController"
    )
    generate(tmp_path, f"import jaus.iop\n{deciding}", "front")
    assert "clients/handoff_client.py" in modules(tmp_path)
    script = "from front.front import Front; print(Front.clients, Front.decide_handoff)"
    done = run("-c", script, PYTHONPATH=python_path(tmp_path / "src"))
    assert "HandoffClient" in done.stdout, done.stderr


@for_each(
    ("connection", "parts"),
    [
        ("TopicsToReport", set()),
        ("RosServiceToJaus", {"services", "introspection"}),
        ("JausToRosService", {"services", "introspection"}),
        ("ListToAction", {"actions", "action_work", "introspection"}),
        ("ActionToList", {"actions", "action_work", "introspection"}),
    ],
)
def test_a_node_has_the_parts_that_connections_ask_for(connection, parts):
    code = f"from {FACE} import {connection}, run_bridge"
    found = {name.rpartition(".")[2] for name in needed([("a.py", code)]) if "bridge.ros." in name}
    assert found & {"services", "introspection", "actions", "action_work"} == parts


def test_what_modules_import_is_there(begun, tmp_path):
    begun(tmp_path, FRONT, "front")
    lines = (f"from {FACE} import {name}" for name in ("Bridge", "Topic"))
    kept = needed([("a.py", "\n".join(lines))])
    for name in kept:
        for module, imported in runtime_modules()[name].imports:
            if not runtime_modules()[name].passes_on:
                assert module in kept, (name, imported)


def test_a_node_that_is_no_bridge_has_nothing_of_jaus():
    found = {name for name in needed([("a.py", f"from {FACE} import run_node")]) if name}
    assert {name.split(".")[0] for name in found} == {"base", "bridge", "conversions", "wire"}
    assert not {"bridge.process", "bridge.bridge", "base.loop", "base.settings"} & found


def test_the_manifest_says_for_which_code_a_module_is_there(begun, tmp_path):
    begun(tmp_path, TALKER, "talk")
    manifest = json.loads((tmp_path / "src" / MANIFEST_PATH).read_text("utf-8"))
    entry = manifest["files"][f"{FACE}/{FACE}/component/process.py"]
    assert entry["element"] == "runtime:component/process.py for talker/talker/main.py"


def test_models_of_one_workspace_share_what_both_need(begun, tmp_path):
    begun(tmp_path, FRONT, "front")
    alone = modules(tmp_path)
    generate(tmp_path, TALKER, "talk")
    assert modules(tmp_path) == alone | modules(tmp_path)
    starts(tmp_path / "src", "front")
    starts(tmp_path / "src", "talker")
    assert generate(tmp_path, FRONT, "front", write=False).plan.is_up_to_date


def test_models_that_are_generated_at_once_share_what_both_need(tmp_path, monkeypatch):
    both = Barrier(2)

    def rendered_together(*arguments):
        artifacts = render(*arguments)
        with suppress(BrokenBarrierError):
            both.wait(0.3)
        return artifacts

    monkeypatch.setattr("jausml.generation.workspace.render", rendered_together)
    models = (FRONT, "front"), (TALKER, "talk")
    with ThreadPoolExecutor() as runs:
        list(runs.map(lambda model: generate(tmp_path, *model), models))
    starts(tmp_path / "src", "front")
    starts(tmp_path / "src", "talker")


def test_the_runtime_alone_is_that_of_the_code_that_is_there(begun, tmp_path):
    begun(tmp_path, TALKER, "talk")
    before = modules(tmp_path)
    generate(tmp_path, TALKER, "talk", [RUNTIME.for_whole_library()])
    assert len(modules(tmp_path)) == len(runtime_modules())
    generate(tmp_path, TALKER, "talk", [RUNTIME])
    assert modules(tmp_path) == before


@pytest.mark.parametrize(
    "line", ["from jausml_runtime.virtual import VirtualWorld", "from jausml_runtime import Bridge"]
)
def test_code_of_users_brings_what_it_imports(begun, tmp_path, line):
    begun(tmp_path, TALKER, "talk")
    before = modules(tmp_path)
    own = tmp_path / "src" / "talker" / "talker" / "own.py"
    used = "print(VirtualWorld, Bridge, jausml_runtime)\n"
    own.write_text(f"{line}\n{used}", encoding="utf-8")
    assert generate(tmp_path, TALKER, "talk").drift == ()
    assert modules(tmp_path) > before
    own.unlink()
    generate(tmp_path, TALKER, "talk")
    assert modules(tmp_path) == before


def test_a_package_passes_on_what_is_kept_alone():
    module = runtime_modules()["wire"]
    text = copied(module, {"": "", "wire": "", "wire.message": "", "wire.codec": ""})
    names = [node.names for node in ast.parse(text).body if isinstance(node, ast.ImportFrom)]
    assert {alias.name for group in names for alias in group}.isdisjoint({"Octet"})
    assert "Message as Message" in text
    assert copied(module, runtime_modules()) == module.text


def test_modules_of_the_runtime_have_all_that_they_import():
    for module in runtime_modules().values():
        imports = {
            alias.name.partition(".")[0] if isinstance(node, ast.Import) else node.module
            for node in ast.walk(ast.parse(module.text))
            if isinstance(node, ast.Import) or (isinstance(node, ast.ImportFrom) and not node.level)
            for alias in node.names
        }
        assert module.foreign == {name.partition(".")[0] for name in imports}, module.name


@for_each(
    "code",
    [
        f"import os; from {FACE}.virtual import world",
        f"if os.name: import {FACE}.virtual.world",
        f"from {FACE}.virtual \\\n    import world",
        f"from  \\\n {FACE}.virtual  import world",
        f"from {FACE}.virtual import (  # the world (of one loop)\n    world,\n)",
        f"\tfrom {FACE}.virtual import world  # (for the loop",
        f'"""It may\nimport (much)\n"""\nfrom {FACE}.virtual import world',
    ],
)
def test_imports_of_any_layout_count(code):
    text = f"class Loop:\n{code}" if code.startswith("\t") else code
    assert "virtual.world" in needed([("a.py", f"{text}\n")])


def test_imports_in_functions_and_for_type_checkers_count():
    code = f"""
def start():
    from {FACE} import run_component
if TYPE_CHECKING:
    import {FACE}.virtual.world
"""
    found = needed([("a.py", code)])
    assert {"component.process", "virtual.world", "virtual.graph"} <= set(found)


def test_files_of_older_runs_and_damaged_ones_ask_for_nothing():
    damaged = [("a.py", f"from {FACE} import ("), ("b.py", f"from {FACE}.gone import Name")]
    assert needed([*damaged, ("c.py", "import os")]) == {}
