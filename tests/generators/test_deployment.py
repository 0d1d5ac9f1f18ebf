"""What is generated for each host: units, containers, firewalls, keys; judged by their readers."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from pathlib import Path

import needs
import pytest
import yaml
from deployed import install, moved, read_environment, read_unit, started
from generated import model_in, text_of, texts_of
from scripts import succeeded

from jausml.generation.errors import GenerationError
from jausml.generation.rendering import render
from jausml.generation.workspace import generate, select
from jausml.runtime.transports.ports import neighbour_ports
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.deployment.network import HIGHEST_SHARED_PORT, dds_ports
from jausml_generators.deployment.target import TARGET as DEPLOYMENT

ROOT = Path(__file__).resolve().parents[2]
TWO_HOSTS = (ROOT / "tests" / "live" / "two_hosts.ros2jaus").read_text(encoding="utf-8")
STATION = next(n for n, line in enumerate(TWO_HOSTS.splitlines(), 1) if "host station" in line)
WORST_EXPOSURE = 20  # tenths; systemd calls up to 2.0 "OK", and a service that says nothing 9.6
MAPS = "import mappings.velocity_state_sensor\n"
VEHICLE = "component vehicle { address: 100.1.1  provides: VelocityStateSensor  external: true }\n"
WATCHER = """bridge watcher {
    address: 100.1.20
    allowed: none
    connection velocity { map: velocity_state  peers: vehicle  rate: 10  topic odometry }
}
"""


def watcher(settings=""):
    return WATCHER.replace("    allowed: none\n", settings)


VARIANTS = {
    "multicast": TWO_HOSTS,
    "tcp": TWO_HOSTS.replace("transport: judp", "transport: jtcp"),
    "manager": TWO_HOSTS.replace("transport: judp", "transport: nodeManager"),
    "no multicast": TWO_HOSTS.replace("transport: judp", "multicastTtl: 0"),
    "one computer": MAPS + VEHICLE + watcher() + "host computer {}\n",
    "stranger": MAPS + VEHICLE + watcher() + 'host computer { interface: "10.0.0.9" }\n',
    "stated": MAPS
    + VEHICLE.replace("external", 'endpoint: "10.0.3.7:4000"  external')
    + watcher()
    + 'host computer { interface: "10.0.0.9" }\n',
    "named": MAPS
    + VEHICLE.replace("external", 'endpoint: "rover.local"  external')
    + watcher()
    + 'host computer { interface: "10.0.0.9" }\n',
    "allowed": MAPS
    + VEHICLE
    + watcher('    allowedHosts: "10.0.0.0/24", "10.0.0.7", "10.0.1.7"\n')
    + 'host computer { interface: "10.0.0.9" }\n',
}


@pytest.fixture(scope="module")
def model_of(tmp_path_factory):
    return lambda text: model_in(tmp_path_factory.mktemp("model"), text, "rover.ros2jaus")


@pytest.fixture(scope="module")
def files_of(model_of):
    """The files of a variant, by their path in the folder of the deployment."""
    made = {}

    def of(name):
        if name not in made:
            files = texts_of(model_of(VARIANTS[name]), [DEPLOYMENT])
            assert all(path.startswith("rover_deployment/") for path in files)
            made[name] = {path.partition("/")[2]: text for path, text in files.items()}
        return made[name]

    return of


@pytest.fixture(scope="module")
def workspace(tmp_path_factory, model_of):
    out = tmp_path_factory.mktemp("rover")
    generate(model_of(TWO_HOSTS), [BRINGUP, DEPLOYMENT], out)
    return out


@pytest.fixture(scope="module")
def image(workspace, tmp_path_factory):
    """The tree of a computer on which the host `onboard` is installed."""
    folder = tmp_path_factory.mktemp("image")
    install(workspace / "rover_deployment" / "hosts" / "onboard", folder)
    return folder


def test_it_is_made_on_request_and_then_follows_the_model(model_of, tmp_path):
    installed = {"bringup": BRINGUP, "deployment": DEPLOYMENT}
    folder = tmp_path / "rover_deployment"
    changed = TWO_HOSTS.replace("10.77.0.2", "10.77.0.3")

    def run(text, *names, write=True):
        chosen = select(installed, names)
        settings = {"kept": chosen.kept, "renewed": chosen.renewed, "write": write}
        return generate(model_of(text), chosen.targets, tmp_path, **settings).plan

    run(TWO_HOSTS)
    assert not folder.exists()
    run(TWO_HOSTS, "deployment")
    assert run(TWO_HOSTS).is_up_to_date
    plan = run(changed, write=False)
    assert "rover_deployment/hosts/station/firewall.nft" in {change.path for change in plan.changes}
    run(changed)
    assert "10.77.0.3" in (folder / "hosts" / "station" / "firewall.nft").read_text()
    on_one_computer = TWO_HOSTS.replace("10.77.0.2", "127.0.0.1")
    with pytest.raises(GenerationError, match=r"no other host reaches \(to go without, delete"):
        run(on_one_computer)
    shutil.rmtree(folder)
    run(on_one_computer)
    assert not folder.exists()


def test_each_host_has_what_runs_on_it(files_of):
    files = files_of("multicast")
    units = sorted(path for path in files if path.endswith(".service"))
    assert units == [
        "hosts/onboard/jaus-rover-display.service",
        "hosts/onboard/jaus-rover-trailer.service",
        "hosts/onboard/jaus-rover-vehicle.service",
        "hosts/station/jaus-rover-watcher.service",
    ]
    wants = read_unit(files["hosts/onboard/jaus-rover.target"])["Wants"]
    assert wants == [f"jaus-rover-{name}.service" for name in ("vehicle", "trailer", "display")]
    assert "display" not in "".join(
        text for path, text in files.items() if path.startswith("hosts/station/")
    )


def test_a_unit_starts_its_process_with_what_it_reads_and_no_more(files_of):
    files = files_of("multicast")
    vehicle = read_unit(files["hosts/onboard/jaus-rover-vehicle.service"])
    watcher = read_unit(files["hosts/station/jaus-rover-watcher.service"])
    start = "/usr/local/lib/jaus/rover/start.sh"
    assert vehicle["ExecStart"] == [f"{start} vehicle.main"]
    assert watcher["ExecStart"] == [
        f"{start} watcher.main --ros-args"
        " --params-file /etc/jaus/rover/watcher.yaml --enclave /watcher"
    ]
    local = "-/etc/jaus/rover/local.env"
    assert vehicle["EnvironmentFile"] == ["/etc/jaus/rover/jaus.env", local]
    assert watcher["EnvironmentFile"] == [
        *("/etc/jaus/rover/jaus.env", "/etc/jaus/rover/ros.env"),
        local,
    ]
    for unit in (vehicle, watcher):
        assert unit["User"] == ["jaus"]
        assert unit["CapabilityBoundingSet"] == [""]
        assert unit["Restart"] == ["on-failure"]
        assert (unit["NotifyAccess"], unit["WatchdogSec"]) == (["main"], ["10"])
    display = read_unit(files["hosts/onboard/jaus-rover-display.service"])
    assert "WatchdogSec" not in display


def test_what_is_installed_is_what_the_units_name(image):
    assert (image / "etc" / "sysusers.d" / "jaus.conf").is_file()
    for unit in ("vehicle", "display"):
        command, environment = started(image, f"jaus-rover-{unit}.service")
        assert os.access(command[0], os.X_OK)
        assert all(Path(word).is_file() for word in command if word.endswith(".yaml"))
        assert ("ROS_DOMAIN_ID" in environment) is (unit == "display")
    assert environment["ROS_STATIC_PEERS"] == "10.77.0.2"
    assert environment["ROS_DOMAIN_ID"] == "7"


def test_files_of_users_stay_and_units_of_former_processes_go(workspace, tmp_path):
    host = workspace / "rover_deployment" / "hosts" / "onboard"
    install(host, tmp_path)
    settings = tmp_path / "etc" / "jaus" / "rover"
    yours = ["local.env", "display.yaml", "firewall.local.nft"]
    for name in yours:
        (settings / name).write_text("mine\n", encoding="utf-8")
    (settings / "ros.env").write_text("old\n", encoding="utf-8")
    former = tmp_path / "etc" / "systemd" / "system" / "jaus-rover-former.service"
    other = former.with_name("jaus-winch-arm.service")
    for unit in (former, other):
        unit.write_text("[Service]\n", encoding="utf-8")
    install(host, tmp_path)
    assert all((settings / name).read_text(encoding="utf-8") == "mine\n" for name in yours)
    assert "ROS_DOMAIN_ID" in (settings / "ros.env").read_text(encoding="utf-8")
    assert not former.exists()
    assert other.exists()


@pytest.mark.needs("systemd-analyze")
@pytest.mark.parametrize("variant", ["multicast", "manager"])
def test_systemd_takes_the_units_and_calls_them_hardened(variant, model_of, tmp_path):
    generate(model_of(VARIANTS[variant]), [DEPLOYMENT], tmp_path / "src")
    image = tmp_path / "image"
    install(tmp_path / "src" / "rover_deployment" / "hosts" / "onboard", image)
    base = image / "usr" / "lib" / "systemd" / "system"
    base.mkdir(parents=True)
    for path in Path("/usr/lib/systemd/system").glob("*.target"):
        shutil.copy(path, base)
    units = sorted((image / "etc" / "systemd" / "system").iterdir())
    line = ["systemd-analyze", "verify", f"--root={image}", *(unit.name for unit in units)]
    verified = subprocess.run(line, capture_output=True, text=True, timeout=60)
    assert (verified.returncode, verified.stdout + verified.stderr) == (0, "")
    services = [str(unit) for unit in units if unit.suffix == ".service"]
    line = ["systemd-analyze", "security", "--offline=yes", f"--threshold={WORST_EXPOSURE}"]
    succeeded([*line, *services], timeout=60)


@pytest.mark.parametrize("variant", ["multicast", "manager"])
def test_containers_run_what_the_units_run_without_privileges(variant, files_of):
    files = files_of(variant)
    for host in ("onboard", "station"):
        folder = f"hosts/{host}"
        composed = yaml.safe_load(files[f"{folder}/compose.yaml"])
        assert composed["name"] == "rover"
        units = [path for path in files if path.startswith(folder) and path.endswith(".service")]
        assert {f"{folder}/jaus-rover-{name}.service" for name in composed["services"]} == {*units}
        for name, service in composed["services"].items():
            unit = read_unit(files[f"{folder}/jaus-rover-{name}.service"])
            assert service["command"] == unit["ExecStart"][0].split()[1:]
            read = [Path(file_name.removeprefix("-")).name for file_name in unit["EnvironmentFile"]]
            assert service["env_file"] == read
            mounts = service.get("volumes", [])
            wanted = [word for word in service["command"] if word.endswith(".yaml")]
            assert [f"./{name}.yaml:{word}:ro" for word in wanted] == [
                mount for mount in mounts if mount.endswith(":ro")
            ]
            assert ("/tmp:/tmp" in mounts) is (variant == "manager" and "jaus.env" in read)
            for file in (*read, *(f"{name}.yaml" for _ in wanted)):
                assert f"{folder}/{file}" in files
            check_confined(service)
            assert f"{folder}/{service['build']['context']}" == f"{folder}/../../.."
            dockerfile = service["build"]["dockerfile"]
            assert dockerfile.removeprefix("rover_deployment/") in files


def test_a_process_may_be_called_by_a_word_of_yaml(model_of):
    text = VARIANTS["one computer"].replace("bridge watcher", "bridge on")
    files = texts_of(model_of(text), [DEPLOYMENT])
    composed = yaml.safe_load(files["rover_deployment/hosts/computer/compose.yaml"])
    assert list(composed["services"]) == ["on"]


def test_compose_takes_the_files(workspace):
    files = sorted(map(str, workspace.glob("rover_deployment/hosts/*/compose.yaml")))
    assert len(files) == 2
    line = ["-m", "check_jsonschema", "--builtin-schema", "vendor.compose-spec", *files]
    succeeded([sys.executable, *line], timeout=60)


def check_confined(service):
    assert service["user"].split(":")[0] not in ("", "0", "root")
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert service["read_only"] is True
    assert service["network_mode"] == "host"
    assert service["restart"] == "on-failure"
    assert not {"privileged", "cap_add", "devices", "pid", "ipc"} & set(service)


def test_the_image_ends_as_the_user_and_has_what_containers_start(files_of):
    lines = files_of("multicast")["Containerfile"].splitlines()
    last = lines[len(lines) - 1 - lines[::-1].index("USER 3794:3794") :]
    assert last == ["USER 3794:3794", 'ENTRYPOINT ["/usr/local/lib/jaus/rover/start.sh"]']
    assert "COPY rover_deployment/start.sh /usr/local/lib/jaus/rover/start.sh" in lines
    assert "start.sh" in files_of("multicast")


def test_the_image_that_is_shipped_has_no_file_that_lies_beside_the_packages(files_of):
    """A keystore may: what a layer once had stays in the image."""
    *_, shipped = files_of("multicast")["Containerfile"].split("\nFROM ")
    copied = [line.split()[1:-1] for line in shipped.splitlines() if line.startswith("COPY")]
    assert copied == [
        ["--from=build", "/manifests"],
        ["--from=build", "/opt/jaus/rover"],
        ["rover_deployment/start.sh"],
    ]


def accepted(firewall):
    """The rules that let something in, besides those that every host has."""
    lines = [line.strip() for line in firewall.splitlines()]
    return [line for line in lines if line.endswith(" accept") and line.startswith("ip ")]


def elements(firewall, name):
    found = re.search(rf"set {name} {{[^}}]*elements = {{ ([^}}]*) }}", firewall)
    return found.group(1).split(", ") if found else []


def test_the_firewall_of_a_host_names_what_the_model_has(files_of):
    rules = files_of("multicast")["hosts/station/firewall.nft"]
    assert "policy drop;" in rules
    assert elements(rules, "jaus_hosts") == elements(rules, "ros_hosts") == ["10.77.0.1"]
    assert accepted(rules) == [
        "ip saddr @jaus_hosts ip daddr 10.77.0.2 udp dport { 3794 } accept",
        "ip protocol igmp accept",
        "ip saddr @jaus_hosts ip daddr 239.255.0.1 udp dport 3794 accept",
        "ip saddr 10.77.0.2 ip daddr 239.255.0.1 udp dport 3794 accept",
        "ip saddr @jaus_hosts icmp type echo-request limit rate 10/second accept",
        "ip saddr @ros_hosts ip daddr 10.77.0.2 udp dport 9160-9399 accept",
    ]


def test_a_host_on_which_the_model_runs_nothing_may_come(model_of):
    idle = 'host topside { interface: "10.77.0.3" }'
    text = TWO_HOSTS.replace("    host station", f"    {idle}\n    host station")
    rules = text_of(model_of(text), [DEPLOYMENT], "station/firewall.nft")
    assert elements(rules, "jaus_hosts") == ["10.77.0.1", "10.77.0.3"]
    assert elements(rules, "ros_hosts") == ["10.77.0.1"]


def test_over_tcp_and_without_multicast_less_is_open(files_of):
    tcp = accepted(files_of("tcp")["hosts/station/firewall.nft"])
    assert tcp[0] == "ip saddr @jaus_hosts ip daddr 10.77.0.2 tcp dport { 3794 } accept"
    assert not any("239.255.0.1" in rule or "igmp" in rule for rule in tcp)
    alone = accepted(files_of("no multicast")["hosts/station/firewall.nft"])
    groups = [rule for rule in alone if "239.255.0.1" in rule]
    assert groups == ["ip saddr 10.77.0.2 ip daddr 239.255.0.1 udp dport 3794 accept"]


def test_a_computer_of_its_own_is_closed(files_of):
    rules = files_of("one computer")["hosts/computer/firewall.nft"]
    assert accepted(rules) == []
    assert "ROS_STATIC_PEERS" not in files_of("one computer")["hosts/computer/ros.env"]


def test_allowed_hosts_of_a_bridge_may_come(files_of):
    rules = files_of("allowed")["hosts/computer/firewall.nft"]
    assert elements(rules, "jaus_hosts") == ["10.0.0.0/24", "10.0.1.7"]
    assert elements(files_of("stranger")["hosts/computer/firewall.nft"], "jaus_hosts") == []


def test_several_processes_of_a_host_have_the_ports_of_the_runtime(model_of):
    for port in (3794, HIGHEST_SHARED_PORT, HIGHEST_SHARED_PORT + 1):
        model = model_of(TWO_HOSTS.replace("transport: judp", f"port: {port}"))
        files = texts_of(model, [DEPLOYMENT])
        rules = files["rover_deployment/hosts/onboard/firewall.nft"]
        (found,) = re.findall(r"udp dport \{ ([^}]*) \}", rules)
        known = neighbour_ports(port)
        assert found == ", ".join([str(port), *([f"{known[0]}-{known[-1]}"] if known else [])])
        asks = "Which ports have the processes" in files["rover_deployment/README.md"]
        assert asks is not bool(known)


def test_ports_of_a_domain_are_those_of_dds():
    # As the documentation of ROS 2 counts them: 7400 + 250 * domain + 10 and on.
    assert dds_ports(0) == "7410-7649"
    assert dds_ports(101) == "32660-32899"


@pytest.mark.needs("nft")
@pytest.mark.parametrize("variant", VARIANTS)
def test_nft_takes_the_firewalls(variant, files_of, tmp_path):
    for path, text in files_of(variant).items():
        if path.endswith("/firewall.nft"):
            installed = tmp_path / "etc" / "jaus" / "rover"
            installed.mkdir(parents=True, exist_ok=True)
            for name in ("firewall.nft", "firewall.local.nft"):
                source = files_of(variant)[path.replace("firewall.nft", name)]
                # Examples of what else may come are to be right, too.
                (installed / name).write_text(moved(source.replace("\n#ip ", "\nip "), tmp_path))
            line = ["nft", "--check", "--file", str(installed / "firewall.nft")]
            succeeded(line, timeout=60)
            assert text


def test_peers_are_named_where_multicast_does_not_pass(files_of):
    named = "--jaus-peer 100.1.1=10.77.0.1:3794 --jaus-peer 100.1.2=10.77.0.1:3794"
    options = read_environment(files_of("no multicast")["hosts/station/jaus.env"])
    assert options == {"JAUS_OPTIONS": named}
    assert read_environment(files_of("multicast")["hosts/station/jaus.env"])["JAUS_OPTIONS"] == ""
    assert f"\n#JAUS_OPTIONS={named}\n" in files_of("multicast")["hosts/station/local.env"]
    assert "jaus-peer" not in files_of("tcp")["hosts/station/local.env"]  # the model has said it


@pytest.mark.parametrize(
    ("variant", "question"),
    [
        ("stranger", "Where is `vehicle` (100.1.1)?"),
        ("named", "Where is `vehicle` (100.1.1)?"),
        ("manager", "Which node manager has this host"),
        ("multicast", "Who maintains the packages?"),
        ("multicast", "Who administers this computer?"),
    ],
)
def test_what_the_model_does_not_say_is_asked(variant, question, files_of):
    assert question in files_of(variant)["README.md"]


def test_what_the_model_says_is_not_asked(files_of):
    assert "Where is" not in files_of("allowed")["README.md"]
    assert "Where is" not in files_of("stated")["README.md"]
    assert "Where " not in files_of("multicast")["README.md"]


def test_a_bridge_that_takes_from_anybody_is_asked_for_networks(model_of):
    text = VARIANTS["stranger"].replace("peers: vehicle ", "")
    readme = text_of(model_of(text), [DEPLOYMENT], ".md")
    assert "Where are the peers of `velocity` of `watcher`?" in readme


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (MAPS + VEHICLE + watcher(), "has no host to deploy on"),
        (TWO_HOSTS.replace('interface: "10.77.0.2"', ""),
            rf"rover\.ros2jaus:{STATION}:5: host 'station' has the interface 127\.0\.0\.1,"),
        (TWO_HOSTS.replace('"10.77.0.2"', '"10.77.0.2"  port: 3795'),
            rf"{STATION}:\d+: host 'station' has port 3795 and 'onboard' 3794"),
        (TWO_HOSTS.replace("10.77.0.2", "10.77.0.1"),
            rf"{STATION}:\d+: host 'station' has the interface 10\.77\.0\.1, .* of 'onboard'"),
    ],
)  # fmt: skip
def test_hosts_that_cannot_meet_are_refused_with_their_place(text, fault, model_of):
    with pytest.raises(GenerationError, match=fault):
        render(model_of(text), [DEPLOYMENT])


@pytest.mark.parametrize("name", ["start.sh", "keystore.sh", "hosts/onboard/install.sh"])
def test_scripts_are_of_their_shell(name, workspace):
    script = workspace / "rover_deployment" / name
    assert os.access(script, os.X_OK)
    shell = script.read_text(encoding="utf-8").splitlines()[0].removeprefix("#!")
    done = subprocess.run([shell, "-n", str(script)], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


COMMANDING = """
import signal, sys
from jausml.runtime.base.loop import Loop
from jausml.runtime.guardian.ward import Ward

with Loop() as loop:
    ward = Ward(loop, dict, lambda: 0, lambda: None)
    loop.start()
    with loop.lock:
        slot = ward.slots.take("drive", ("own", "vehicle"), lambda: 4660)
        endpoint = ("127.0.0.1", int(sys.argv[1]))
        content = {"data": b"stop..".hex(), "endpoint": endpoint, "slot": slot}
        stops = {"patience": 0.5, "topics": [], "datagrams": [content]}
        ward.guard(lambda: stops).arm(True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(3))
    print("runs", flush=True)
    signal.pause()
"""


@pytest.fixture
def container(workspace, tmp_path):
    """Starts a bridge that commands, as the first process of a container does."""
    made = []
    (tmp_path / "commanding.py").write_text(COMMANDING, encoding="utf-8")
    programs = Path(sys.executable).parent
    setup = f"export PYTHONPATH={tmp_path}:{ROOT}\nexport PATH={programs}:$PATH\n"
    (tmp_path / "setup.bash").write_text(setup, encoding="utf-8")

    def start(port):
        needs.ask("namespaces of processes")
        start = workspace / "rover_deployment" / "start.sh"
        line = [*needs.FIRST_PROCESS, "bash", str(start), "commanding", str(port)]
        environment = {**os.environ, "JAUS_WORKSPACE": str(tmp_path)}
        pipe = subprocess.PIPE
        made.append(subprocess.Popen(line, env=environment, stdout=pipe))
        assert made[-1].stdout.readline() == b"runs\n"
        return made[-1]

    yield start
    for process in made:
        process.kill()
        process.communicate(timeout=60)


def bridge_in(container):
    """The process that the first one of a container has started, as seen from outside."""
    first = children(container.pid)[0]
    return next(child for child in children(first) if b"commanding" in command(child))


def children(process):
    there = Path(f"/proc/{process}/task/{process}/children")
    return [int(word) for word in there.read_text(encoding="utf-8").split()]


def command(process):
    return Path(f"/proc/{process}/cmdline").read_bytes()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV])
def test_in_a_container_the_guardian_outlives_its_bridge(container, number):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        vehicle.settimeout(20)
        first = container(vehicle.getsockname()[1])
        os.kill(bridge_in(first), number)
        assert vehicle.recv(100) == b"stop\x34\x12"
        assert first.wait(60) == 128 + number


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_in_a_container_signals_are_for_the_bridge(container, number):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        first = container(vehicle.getsockname()[1])
        os.kill(children(first.pid)[0], number)
        assert first.wait(60) == 3  # as the bridge ended, not as the signal says


# As much of `ros2 security` as the script uses, with the files that sros2 makes.
ROS2 = """#!/bin/bash
set -eu
echo "$@ in $ROS_DOMAIN_ID" >> "$(dirname "$0")/calls"
test "$1" = security
case $2 in
create_keystore) mkdir -p "$3"/{enclaves,private,public}
    touch "$3/private/ca.key.pem" "$3/public/ca.cert.pem" "$3/enclaves/governance.p7s" ;;
create_enclave) mkdir -p "$3/enclaves$4"; touch "$3/enclaves$4/"{key.pem,cert.pem} ;;
create_permission) test -f "$5"; touch "$3/enclaves$4/permissions.p7s" ;;
esac
"""


def test_hosts_get_the_keys_of_their_processes_and_none_that_signs(workspace, tmp_path):
    program = tmp_path / "bin" / "ros2"
    program.parent.mkdir()
    program.write_text(ROS2, encoding="utf-8")
    program.chmod(0o755)
    keys = tmp_path / "keys"
    environment = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"}
    line = [str(workspace / "rover_deployment" / "keystore.sh"), str(keys)]
    for _ in range(2):
        subprocess.run(line, env=environment, check=True, capture_output=True, timeout=60)
    calls = (program.parent / "calls").read_text(encoding="utf-8").splitlines()
    assert [call.split()[1] for call in calls].count("create_enclave") == 2  # keys stay
    assert all(call.endswith(" in 7") for call in calls)
    for host, process in (("station", "watcher"), ("onboard", "display")):
        own = keys / "hosts" / host
        found = {path.relative_to(own).as_posix() for path in own.rglob("*") if path.is_file()}
        assert found == {
            "public/ca.cert.pem",
            "enclaves/governance.p7s",
            *(f"enclaves/{process}/{name}" for name in ("cert.pem", "key.pem", "permissions.p7s")),
        }
        assert (own / "enclaves" / process / "key.pem").stat().st_mode & 0o077 == 0
