"""`jausml run`, with real processes."""

import ast
import json
import os
import signal
import subprocess
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import warm

from jausml import __version__, installing
from jausml.cli.live import run as run_verb
from jausml.cli.live import supervisor

READY = """\
import signal, sys, time
{setup}
print("ready", sys.argv[1:], flush=True)
while True:
    time.sleep(0.05)
"""
OBEDIENT = READY.format(setup="signal.signal(signal.SIGINT, lambda *_: sys.exit(0))")
DEAF = READY.format(
    setup="for each in (signal.SIGINT, signal.SIGTERM): signal.signal(each, signal.SIG_IGN)"
)


@pytest.fixture
def workspace(here):
    """Makes a generated workspace of processes with the given programs."""

    def make(kind="component", **programs):
        processes = []
        for name, program in programs.items():
            package = here / "out" / name / name
            package.mkdir(parents=True)
            (package / "__init__.py").write_text("")
            (package / "main.py").write_text(program)
            process = {"name": name, "kind": kind, "package": name, "module": f"{name}.main"}
            processes.append({**process, "arguments": ["--jaus-port", "4000"]})
        write_manifest(here / "out", processes)
        return here / "out"

    return make


def write_manifest(out, processes):
    (out / ".jausml").mkdir(parents=True, exist_ok=True)
    content = {
        "schema": 2,
        "generator": f"jausml {__version__}",
        "files": {},
        "models": {"demo": {"processes": processes}},
    }
    (out / ".jausml" / "manifest.json").write_text(json.dumps(content))


def start(*arguments):
    return subprocess.Popen(
        [*warm.command(), "run", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )


def read_until(process, *texts):
    """Reads lines until each text was seen; returns what was read."""
    seen = ""
    while not all(text in seen for text in texts):
        line = process.stdout.readline()
        assert line, f"ended early: {seen}{process.stderr.read()}"
        seen += line
    return seen


def finish(process):
    out, err = process.communicate(timeout=30)
    return process.returncode, out, err


def test_all_end_by_themselves(jausml, workspace):
    out = workspace(
        alpha="print('one')\nprint('two')",
        beta="import sys, alpha\nprint(sys.argv[1:])\nprint('x', file=sys.stderr)",
    )
    result = jausml("run", out)
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    assert [line for line in lines if line.startswith("alpha | ")] == ["alpha | one", "alpha | two"]
    assert "beta  | ['--jaus-port', '4000']" in lines
    assert "beta  | x" in lines


def test_only_some_processes(jausml, refused, workspace):
    out = workspace(alpha="print('one')", beta="print('two')")
    result = jausml("run", out, "--only", "beta")
    assert result.stdout == "beta | two\n"
    refused("no process 'gamma'; there are alpha, beta", "run", out, "--only", "gamma")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signal_stops_all_cleanly(workspace, number):
    process = start(workspace(alpha=OBEDIENT, beta=OBEDIENT))
    read_until(process, "alpha | ready", "beta  | ready")
    process.send_signal(number)
    code, _, err = finish(process)
    assert (code, err) == (0, "")


def test_time_is_over(workspace):
    process = start(workspace(alpha=OBEDIENT), "--for", "0.5")
    read_until(process, "ready")
    code, _, err = finish(process)
    assert (code, err) == (0, "")


def test_any_time_may_be_given(jausml, workspace):
    result = jausml("run", workspace(alpha="print('one')"), "--for", "1e300")
    assert (result.exit_code, result.stdout) == (0, "alpha | one\n")


def test_failure_of_one_stops_the_others(workspace, tmp_path):
    ready = tmp_path / "ready"
    alpha = f"{OBEDIENT.partition('print')[0]}open({str(ready)!r}, 'x')\n"
    alpha += "".join(OBEDIENT.partition("print")[1:])
    # A process that is told to end while Python itself begins cannot obey.
    beta = f"""
import pathlib, sys, time
end = time.monotonic() + 20
while not pathlib.Path({str(ready)!r}).exists() and time.monotonic() < end:
    time.sleep(0.01)
sys.exit('broken')
"""
    process = start(workspace(alpha=alpha, beta=beta))
    code, out, err = finish(process)
    assert code == 1
    assert "beta  | broken" in out
    assert err == "jausml: beta ended with exit status 1; all others were stopped\n"


def test_killed_process_is_named_by_its_signal(workspace):
    program = "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)"
    code, _, err = finish(start(workspace(alpha=program)))
    assert code == 1
    assert err == "jausml: alpha was ended by SIGKILL\n"


def test_second_signal_does_not_wait(workspace):
    process = start(workspace(alpha=DEAF))
    read_until(process, "ready")
    for _ in range(3):
        process.send_signal(signal.SIGINT)
        time.sleep(0.1)  # signals that arrive together count as one
    code, _, err = finish(process)
    assert code == 1
    assert "alpha was ended by SIGKILL when it was stopped" in err


def test_deaf_process_is_killed_after_the_grace(jausml, workspace, monkeypatch):
    grace = tuple((number, 0.2) for number, _ in supervisor.GRACE[:2])
    monkeypatch.setattr(supervisor, "GRACE", (*grace, supervisor.GRACE[2]))
    result = jausml("run", workspace(alpha=DEAF), "--for", "0.5")
    assert result.exit_code == 1
    assert "alpha was ended by SIGKILL when it was stopped" in result.stderr


def wait_until_gone(pid):
    """Waits until a process has ended; whether init has reaped an orphan is no matter of ours."""
    until = time.monotonic() + 60
    while time.monotonic() < until:
        try:
            state = Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return
        if state in "ZX":
            return
        time.sleep(0.01)
    pytest.fail(f"process {pid} is still there")


def test_children_of_a_process_stop_too(workspace):
    child = "import time; print('child', flush=True); time.sleep(600)"
    program = (
        "import subprocess, sys\n"
        f"child = subprocess.Popen([sys.executable, '-c', {child!r}])\n"
        "print('pid', child.pid, flush=True)\n"
        "child.wait()\n"
    )
    process = start(workspace(alpha=program))
    seen = read_until(process, "pid", "child")
    pid = int(seen.split("pid ")[1].split()[0])
    process.send_signal(signal.SIGINT)
    finish(process)
    wait_until_gone(pid)


def test_no_process_is_left_when_the_reader_goes_away(workspace):
    chatty = (
        "import os, time\nwhile True:\n    print(os.getpid(), flush=True)\n    time.sleep(0.02)"
    )
    process = start(workspace(alpha=chatty))
    pid = int(process.stdout.readline().split("|")[1])
    process.stdout.close()
    process.wait(30)
    process.stderr.close()
    wait_until_gone(pid)


def test_lines_that_nobody_reads_are_no_second_signal(workspace, tmp_path):
    ended = tmp_path / "ended"
    program = (
        "import signal, sys, time\nfrom pathlib import Path\n"
        "def end(*_):\n"
        "    for _ in range(20):\n        print('ending', flush=True)\n        time.sleep(0.02)\n"
        f"    Path({str(ended)!r}).touch()\n    sys.exit()\n"
        "signal.signal(signal.SIGINT, end)\n"
        "while True:\n    print('on', flush=True)\n    time.sleep(0.01)"
    )
    process = start(workspace(alpha=program))
    read_until(process, "on")
    process.stdout.close()
    process.wait(30)
    process.stderr.close()
    assert ended.exists()


def test_environment_is_passed_on_and_packages_are_found(jausml, workspace, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
    monkeypatch.setenv("PYTHONPATH", "/elsewhere")
    program = (
        "import os, sys\n"
        "print(os.environ['ROS_DOMAIN_ID'], os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE'))\n"
        "print('/elsewhere' in sys.path)\n"
    )
    result = jausml("run", workspace(alpha=program))
    assert result.stdout == "alpha | 42 None\nalpha | True\n"


def test_parameter_file_is_handed_to_ros_nodes(jausml, workspace):
    out = workspace(alpha="import sys\nprint(sys.argv[3:])")
    entry = {"name": "alpha", "kind": "component", "module": "alpha.main", "arguments": ["a", "b"]}
    write_manifest(out, [{**entry, "parameters": "x_bringup/config/alpha.yaml"}])
    expected = ["--ros-args", "--params-file", str(out / "x_bringup/config/alpha.yaml")]
    assert jausml("run", out).stdout == f"alpha | {expected}\n"


def test_colcon_workspace_is_its_src(jausml, workspace):
    out = workspace(alpha="print('one')")
    Path("ws").mkdir()
    out.rename("ws/src")
    assert jausml("run", "ws").stdout == "alpha | one\n"


@pytest.mark.needs("compiler")
def test_what_is_compiled_before_the_processes_start_is_told(jausml, workspace):
    out = workspace("bridge", alpha="print('one')")
    source = out / "alpha" / "core" / "core.cpp"
    source.parent.mkdir()
    source.write_text('extern const char jausml_digest[]; const char jausml_digest[] = "d1";\n')
    result = jausml("run", out)
    assert result.stdout == "alpha | one\n", result.stderr
    told = "the translations of alpha are compiled, once, before anything runs\n"
    assert result.stderr == told
    assert jausml("run", out).stderr == ""


def test_what_is_no_workspace(refused, tmp_path):
    refused("is no generated workspace: it has no .jausml/manifest.json", "run", tmp_path)


@pytest.mark.parametrize(
    "processes",
    [
        None,
        {},
        [1],
        [{"name": "a", "kind": "node", "module": "os; import x"}],
        [{"name": "a", "kind": "node", "module": "-c"}],
        [{"name": "a", "kind": "node", "module": "a.main", "arguments": [1]}],
        [{"name": "a", "kind": "node", "module": "a.main", "arguments": "xy"}],
        [{"name": "a", "kind": "node", "module": "a.main", "domain": "0"}],
        [],
    ],
)
def test_damaged_manifest(jausml, tmp_path, processes):
    write_manifest(tmp_path, processes)
    result = jausml("run", tmp_path)
    assert result.exit_code == 2
    assert "Traceback" not in result.stderr
    (tmp_path / ".jausml" / "manifest.json").write_text("<<<<<<<")
    assert jausml("run", tmp_path).exit_code == 2


WRONG = [
    ("ROS_DOMAIN_ID", "300", "ROS_DOMAIN_ID is '300': set a number from 0 to 101"),
    ("RMW_IMPLEMENTATION", "rmw_none_cpp", "or unset RMW_IMPLEMENTATION"),
]


@pytest.mark.parametrize(("name", "value", "cure"), WRONG)
def test_an_environment_that_keeps_from_ros_is_told(
    refused, workspace, monkeypatch, name, value, cure
):
    out = workspace(alpha="print('one')")
    entry = {"name": "alpha", "kind": "bridge", "module": "alpha.main", "arguments": []}
    write_manifest(out, [entry])
    monkeypatch.setenv(name, value)
    for line in (("run", out), ("record", "--output", "r.mcap", "--all-topics", "--duration", "1")):
        refused(cure, *line)


def test_missing_rclpy_is_named(jausml, refused, workspace, monkeypatch):
    monkeypatch.setattr(run_verb.importlib.util, "find_spec", lambda _: None)
    refused(installing.command("ros"), "run", workspace(kind="bridge", alpha="print('one')"))
    assert jausml("run", workspace(kind="component", beta="print('two')")).exit_code == 0


def test_modelled_domain_is_used_unless_the_environment_names_one(jausml, workspace, monkeypatch):
    out = workspace(alpha="import os\nprint(os.environ['ROS_DOMAIN_ID'])")
    entry = {"name": "alpha", "kind": "component", "module": "alpha.main", "domain": 7}
    write_manifest(out, [entry])
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    assert jausml("run", out).stdout == "alpha | 7\n"
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert jausml("run", out).stdout == "alpha | 42\n"


# ------------------------------------------------------------------ what is handed on

ECHO = "import sys\nprint(sys.argv[1:])"


def several(workspace, **kinds):
    """A workspace whose processes print what they get; a kind for each."""
    out = workspace(**dict.fromkeys(kinds, ECHO))
    manifest = out / ".jausml" / "manifest.json"
    content = json.loads(manifest.read_text())
    for entry in content["models"]["demo"]["processes"]:
        entry.update(kind=kinds[entry["name"]], arguments=[], package=entry["name"])
        if entry["kind"] != "component":
            entry["parameters"] = f"config/{entry['name']}.yaml"
    manifest.write_text(json.dumps(content))
    return out


def shown(result):
    assert result.exit_code == 0, result.stderr
    lines = (line.split(" | ") for line in result.stdout.splitlines())
    return {name.strip(): ast.literal_eval(text) for name, text in lines}


def params(out, name):
    return ["--ros-args", "--params-file", str(out / "config" / f"{name}.yaml")]


def test_arguments_go_to_those_that_they_are_for(jausml, workspace):
    out = several(workspace, vehicle="component", front="bridge", camera="node")
    handed = ["--jaus-port", "4001", "--ros-args", "-r", "a:=b", "-p", "x.rate:=5.0"]
    assert shown(jausml("run", out, *handed)) == {
        "vehicle": ["--jaus-port", "4001"],
        "front": ["--jaus-port", "4001", *params(out, "front"), *handed[2:]],
        "camera": [*params(out, "camera"), *handed[2:]],
    }


def test_a_named_process_runs_alone_with_its_arguments(jausml, workspace):
    out = several(workspace, vehicle="component", front="bridge", camera="node")
    line = ["--jaus-id", "1.1.9", "--ros-args", "-r", "__ns:=/r2"]
    expected = {"front": [*line[:2], *params(out, "front"), *line[2:]]}
    assert shown(jausml("run", out, "front", *line)) == expected
    assert shown(jausml("run", out, "front", "--", *line)) == expected
    # Options of the command may stand anywhere, those of processes behind --.
    assert shown(jausml("run", out, "front", *line, "--for", "20")) == expected
    assert shown(jausml("run", out, "vehicle", "--", "--for", "x")) == {"vehicle": ["--for", "x"]}


def test_the_frequency_goes_to_bridges_before_what_is_said_in_detail(jausml, workspace):
    out = several(workspace, vehicle="component", front="bridge", camera="node")
    said = ["--ros-args", "-p", "frequency:=20.0"]
    more = ["--ros-args", "-p", "x.rate:=5.0"]
    assert shown(jausml("run", out, "--frequency", "20", *more)) == {
        "vehicle": [],
        "front": [*params(out, "front"), *said, *more],
        "camera": [*params(out, "camera"), *more],
    }
    assert shown(jausml("run", out, "front", "--frequency", "20"))["front"][-3:] == said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["vehicle", "--frequency", "20"], "no process is a bridge, which --frequency is for"),
        (["front", "--frequency", "0"], "0 is not in the range 0.02<=x<=1092"),
        (["fornt"], "no process 'fornt'; there are vehicle, front, camera"),
        (
            ["--jaus-id", "1.1.9"],
            "name the process that gets this --jaus-id: one of vehicle, front",
        ),
        (["--jaus-id=1.1.9"], "name the process that gets this --jaus-id"),
        (["--", "what"], "no process 'what'"),
        (["front", "--only", "camera"], "name the processes by PROCESS or by --only, not by both"),
        (["--only", "camera", "--jaus-port", "1"], "no process speaks JAUS, which --jaus-port"),
        (["vehicle", "--ros-args", "-r", "a:=b"], "no process is a ROS node, which --ros-args"),
        (["front", "what"], "'what' is no option of a process"),
    ],
)
def test_arguments_for_nobody_are_refused(refused, workspace, arguments, words):
    out = several(workspace, vehicle="component", front="bridge", camera="node")
    refused(words, "run", out, *arguments)


# ------------------------------------------------------------------ packages of messages


def needing(workspace, package):
    out = several(workspace, front="bridge")
    (out / "front" / "package.xml").write_text(
        f"<package format='3'><name>front</name><depend>{package}</depend></package>"
    )
    return out


def test_own_messages_that_are_not_built_are_named(jausml, workspace, tmp_path):
    out = needing(workspace, "depot_interfaces")
    (out / "depot_interfaces" / "msg").mkdir(parents=True)
    result = jausml("run", out)
    assert result.exit_code == 2
    assert "front needs depot_interfaces, whose messages are not built yet" in result.stderr
    assert f"`colcon build` in {out} and source install/setup.bash" in result.stderr
    built = tmp_path / "install" / "depot_interfaces"
    built.mkdir(parents=True)
    (built / "__init__.py").touch()
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("PYTHONPATH", str(built.parent))
        assert jausml("run", out).exit_code == 0


@pytest.mark.parametrize(
    ("package", "cure"),
    [
        # The library has it, so ROS has it.
        ("ackermann_msgs", "pip install ros-jazzy-ackermann-msgs (few packages have wheels)"),
        ("tea_kettle_msgs", "`colcon build` where the sources of tea_kettle_msgs are"),
    ],
)
def test_missing_messages_of_others_are_named(jausml, workspace, monkeypatch, package, cure):
    monkeypatch.setattr(run_verb, "PathFinder", SimpleNamespace(find_spec=lambda *_: None))
    result = jausml("run", needing(workspace, package))
    assert result.exit_code == 2
    assert f"front needs {package}, which Python does not find" in result.stderr
    assert cure in result.stderr
    assert ("apt install" in result.stderr) is ("pip" in cure)


@pytest.mark.parametrize("text", ["<package", "<package/>", ""])
def test_a_damaged_package_xml_keeps_nothing_from_running(jausml, workspace, text):
    out = needing(workspace, "x")
    (out / "front" / "package.xml").write_text(text)
    assert jausml("run", out).exit_code == 0


# ------------------------------------------------------------------ ends

PATIENT = READY.format(
    setup="for each in (signal.SIGINT, signal.SIGTERM):\n"
    "    signal.signal(each, lambda *_: (time.sleep(0.3), sys.exit(0)))"
)


def test_a_second_signal_does_no_harm(workspace):
    process = start(workspace(alpha=PATIENT))
    read_until(process, "ready")
    process.send_signal(signal.SIGINT)
    time.sleep(0.1)  # while the process is about to end
    process.send_signal(signal.SIGINT)
    code, _, err = finish(process)
    assert (code, err) == (0, "")


def test_processes_end_when_the_command_is_killed(workspace):
    told = "import os\nprint('pid', os.getpid(), flush=True)\n"
    process = start(workspace(alpha=told + OBEDIENT, beta=told + OBEDIENT))
    seen = read_until(process, "alpha | ready", "beta  | ready")
    pids = [int(line.split()[-1]) for line in seen.splitlines() if "| pid" in line]
    assert len(pids) == 2
    process.kill()
    process.wait(timeout=30)
    for pid in pids:
        wait_until_gone(pid)
    process.stdout.close()
    process.stderr.close()


def test_a_file_of_the_current_folder_is_not_run_instead(jausml, workspace, tmp_path):
    """A script `alpha.py` may lie where the command is given."""
    out = workspace(alpha="print('generated', __name__, __package__)")
    (tmp_path / "alpha.py").write_text("print('script')")
    result = jausml("run", out)
    assert "alpha | generated __main__ alpha" in result.stdout, result.stdout + result.stderr
