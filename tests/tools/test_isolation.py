"""Each worker of the test suite has a network of its own, or one worker has all ports."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from scripts import ran

TESTS = Path(__file__).resolve().parents[1]
PYTHONPATH = f"{TESTS / 'support'} {TESTS.parent / 'tools'}"
PORT = 3794
GROUP = ("239.255.0.1", PORT)
TALK = f"""
import socket
from isolation import isolate
reason = isolate()
assert not reason, reason
sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
sock.bind(("", {PORT}))
here = socket.inet_aton("127.0.0.1")
sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton({GROUP[0]!r}) + here)
sock.sendto(b"hello", {GROUP!r})
sock.settimeout(30)
print(sock.recv(100).decode(), flush=True)
input()
"""
CASES = """
import os, socket, pytest
pytestmark = pytest.mark.ports

@pytest.mark.parametrize("number", range(8))
def test_one_worker_has_all(number):
    print("ran in", os.environ["PYTEST_XDIST_WORKER"], os.environ["ROS_DOMAIN_ID"])
"""
LEFT_OPEN = """
import gc, socket

def test_that_fails():
    left_open = socket.socket()
    assert not left_open

def test_in_which_the_collector_comes():
    gc.collect()
"""
STAYS = """
import fcntl, os, socket, struct
from isolation import SIOCGIFFLAGS, isolate

def network():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        lo = fcntl.ioctl(control, SIOCGIFFLAGS, struct.pack("16sH14x", b"lo", 0))
    namespaces = [os.stat(f"/proc/self/ns/{each}").st_ino for each in ("net", "mnt", "user")]
    return namespaces, lo

before = network()
print(isolate())
print("stayed" if network() == before else "moved")
"""
IN_A_CHROOT = """
set -e
root=$1; shift
mkdir "$root"
for each in /*; do
  if [ -L "$each" ]; then cp -P "$each" "$root"
  elif [ -d "$each" ]; then mkdir "$root$each" && mount --rbind "$each" "$root$each"
  fi
done
exec chroot "$root" "$@"
"""
WITHOUT_NAMESPACES = 'echo 0 > /proc/sys/user/max_net_namespaces && exec "$@"'


ENVIRONMENT = {**os.environ, "PYTHONPATH": str(TESTS / "support")}


def run(*command, **options):
    return ran(command, env=ENVIRONMENT, timeout=100, **options)


@pytest.mark.needs("namespaces")
def test_each_process_has_all_ports_and_groups_to_itself():
    command = [sys.executable, "-c", TALK]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    processes = [subprocess.Popen(command, env=ENVIRONMENT, **pipes) for _ in range(2)]
    # Each hears itself alone, on one and the same port.
    said = [process.stdout.readline() for process in processes]
    for process in processes:
        process.communicate("\n", timeout=30)
    assert said == ["hello\n", "hello\n"]


@pytest.mark.needs("namespaces of users")
def test_where_a_mount_is_refused_the_network_stays(tmp_path):
    """In a chroot the network is given, and `/` is no place that could be mounted anew."""
    inside = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", IN_A_CHROOT, "sh"]
    done = run(*inside, tmp_path / "root", sys.executable, "-c", STAYS)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["[Errno 22] mount: Invalid argument", "stayed"]


@pytest.mark.slow
@pytest.mark.needs("namespaces of users")
def test_one_worker_runs_what_binds_ports_where_the_network_is_shared(tmp_path):
    inside = ["unshare", "--user", "--map-root-user", "sh", "-c", WITHOUT_NAMESPACES, "sh"]
    shutil.copy(TESTS / "conftest.py", tmp_path)
    (tmp_path / "pytest.ini").write_text(
        f"[pytest]\npythonpath = {PYTHONPATH}\nmarkers = ports\n", encoding="utf-8"
    )
    (tmp_path / "test_cases.py").write_text(CASES, encoding="utf-8")
    own = f"--basetemp={tmp_path / 'kept'}"
    pytest_here = (sys.executable, "-m", "pytest", "-rP", "-n", "3", "--dist", "worksteal", own)
    result = run(*inside, *pytest_here, cwd=tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "8 passed" in result.stdout
    assert "network: shared (" in result.stdout
    workers = {line for line in result.stdout.splitlines() if line.startswith("ran in")}
    assert len(workers) == 1


@pytest.mark.slow
def test_what_a_failed_test_left_open_is_no_failure_of_the_next(tmp_path):
    shutil.copy(TESTS / "conftest.py", tmp_path)
    settings = f"[pytest]\npythonpath = {PYTHONPATH}\nfilterwarnings = error\n"
    (tmp_path / "pytest.ini").write_text(settings, encoding="utf-8")
    (tmp_path / "test_cases.py").write_text(LEFT_OPEN, encoding="utf-8")
    result = run(sys.executable, "-m", "pytest", "-p", "no:xdist", cwd=tmp_path)
    assert "1 failed, 1 passed in" in result.stdout, result.stdout + result.stderr
