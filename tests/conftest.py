"""What holds for all tests."""

import gc
import os
import re
import shlex
import signal
import sys
from collections.abc import Generator
from pathlib import Path

import compile_once
import execnet
import pytest
import warm
from hypothesis import settings
from hypothesis.internal.conjecture import providers
from isolation import announce_often, isolate, own_domain
from ports import MOST_WORKERS, worker
from sweeps import MARKING
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling, Scheduling

from jausml.generation.native import compiler

# No test judges the clock: an example that imports something for the first time may take long.
# Examples are few and the same in each run, or JAUSML_EXAMPLES random ones (make test-random).
EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "0"))
settings.register_profile(
    "jausml", deadline=None, max_examples=EXAMPLES or 20, derandomize=not EXAMPLES
)
settings.load_profile("jausml")

pytest_plugins = ["expected_skips", "needs", "processor_time", "shared_library", "browser"]
SHARED_NETWORK = pytest.StashKey[str]()


def pytest_configure(config: pytest.Config) -> None:
    """Isolates this process."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # So a shell starts what it runs in the background, and programs under test inherit it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:  # as nohup does
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
    _forget_settings()
    _draw_from_no_sources()
    own_domain(worker())
    if "JAUSML_FAULTS" not in os.environ:  # What is measured has the settings of users.
        announce_often()
    kept = config.rootpath / ".pytest_cache" / "d"
    compile_once.use(kept / "compiled", compiler())
    os.environ["MYPY_CACHE_DIR"] = str(kept / "mypy")
    config.stash[SHARED_NETWORK] = isolate()


def _forget_settings() -> None:
    """Lets programs under test write as they do for users, and find compiled what was imported."""
    os.environ.pop("PYTHONUNBUFFERED", None)
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False


def _draw_from_no_sources() -> None:
    """Keeps Hypothesis from drawing constants of the modules that happen to be loaded.

    Which they are depends on the tests that a worker has run, so that examples would not be the
    same in each run; and to parse all modules for them takes as long as to import all tests.
    """
    providers._get_local_constants = lambda: providers._local_constants


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leaves out files that have none of the tests which make chooses: reading all takes long."""
    wanted = MARKING.get(config.option.markexpr)
    if wanted is None or not collection_path.match("test_*.py"):
        return None
    return None if re.search(wanted, collection_path.read_text(encoding="utf-8")) else True


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes(config: pytest.Config, specs: list[execnet.XSpec]) -> None:
    """Makes workers forks of one process, but where they are to rewrite what they import."""
    if config.option.assertmode == "plain":
        line = shlex.join(warm.python())
        specs[:] = [execnet.XSpec(f"popen//python={line}") for _ in specs]


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Leaves the garbage collector out: nothing of ten thousand tests can go."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """Keeps the garbage collector from walking through ten thousand tests again and again.

    A model has a hundred thousand objects: a collector that comes more often walks through those
    that are in use, which took a sixth of the time of tests that read models.
    """
    gc.freeze()
    gc.set_threshold(1_000_000, 20, 20)


def pytest_sessionfinish() -> None:
    """Lets pytest look for garbage at its end among what is new: it could not tell whose it is."""
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Lets go of what a failed test holds, or the next one fails: of sockets that are not closed.

    Its frames are kept for debuggers until the next test is called.
    """
    before = item.session.testsfailed
    result = yield
    if item.session.testsfailed > before:
        for kept in {"last_type", "last_value", "last_traceback", "last_exc"} & vars(sys).keys():
            delattr(sys, kept)
        told, sys.unraisablehook = sys.unraisablehook, lambda _: None
        gc.collect()
        sys.unraisablehook = told
    return result


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """More workers than processors: for half of the time tests wait for processes and periods.

    With three for two processors a third of these stood idle. Not many more: what is said to come
    in time shall come on a computer that is busy with tests.
    """
    return min(5 * (os.cpu_count() or 2) // 2, MOST_WORKERS)


@pytest.fixture
def refused(jausml):
    """Runs the command line of a folder of tests, which refuses for a reason what it is told."""

    def run(reason, *arguments, **options):
        result = jausml(*arguments, **options)
        assert result.exit_code == 2, result.output
        assert reason in result.stderr

    return run


def pytest_report_header(config: pytest.Config) -> str:
    """Says where tests bind their ports."""
    reason = config.stash[SHARED_NETWORK]
    if not reason:
        return "network: each process has its own"
    return f"network: shared ({reason}), so that one worker runs all tests marked `ports` or `live`"


class PortsInOneWorker(LoadFileScheduling):
    """Hands out whole files, and those whose tests bind ports or start ROS to one worker."""

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        text = (self.config.rootpath / file).read_text(encoding="utf-8")
        return "ports" if "pytest.mark.ports" in text or "pytest.mark.live" in text else file


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> Scheduling | None:
    """Keeps apart what binds ports where the network is shared."""
    return PortsInOneWorker(config, log) if config.stash[SHARED_NETWORK] else None
