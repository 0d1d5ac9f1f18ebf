"""Feeds a target with inputs that nobody meant: mutated, random, or guided by coverage.

    python tests/fuzz/run.py datagrams --seconds 60
    python tests/fuzz/run.py datagrams --plain --runs 1000000 --seed 1

A target is a module of ``targets`` with ``one_input(data: bytes) -> None``, which raises for an
input that shows a bug, and optionally ``seeds() -> Sequence[bytes]``, inputs to begin with, and
``report() -> str``, told at the end.
"""

import argparse
import difflib
import hashlib
import importlib
import logging
import random
import resource
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

HERE = Path(__file__).parent
EXIT_OK, EXIT_FOUND, EXIT_USAGE = 0, 1, 2

_LONGEST_RANDOM = 200
_MOST_MUTATIONS = 4
_RANDOM_SHARE = 0.1
_WARM_UP_SHARE = 0.2
_CLOCK_EVERY = 64
_INTERESTING = (0, 1, 2, 13, 14, 0x7F, 0x80, 0xFE, 0xFF)


@dataclass(frozen=True)
class Limits:
    """When a plain run ends, and what it may cost.

    Attributes:
        runs: Number of inputs; 0 for no limit.
        seconds: Duration; 0 for no limit.
        growth_mib: Memory that may be added after the first fifth of the run.
    """

    runs: int
    seconds: float
    growth_mib: int


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a target and returns the exit code: 0 nothing found, 1 found, 2 usage.

    Args:
        argv: Command line without the program's name; the process's own when None.
    """
    names = sorted(path.stem for path in (HERE / "targets").glob("[a-z]*.py"))
    parser = argparse.ArgumentParser(prog="fuzz/run.py", description=__doc__.partition("\n")[0])
    parser.add_argument("target", metavar="TARGET", help=", ".join(names))
    parser.add_argument("--seconds", type=float, default=0, help="duration of the run")
    parser.add_argument("--runs", type=int, default=0, help="number of inputs")
    parser.add_argument("--seed", type=int, default=0, help="of the random numbers; default 0")
    parser.add_argument("--plain", action="store_true", help="without guidance by coverage")
    parser.add_argument(
        "--growth", type=int, default=64, metavar="MIB", help="memory a plain run may add"
    )
    options = parser.parse_args(argv)
    if options.target not in names:
        near = difflib.get_close_matches(options.target, names, 1)
        hint = f"; did you mean {near[0]}?" if near else f"; there are {', '.join(names)}"
        parser.error(f"no target {options.target}{hint}")
    if not (options.runs or options.seconds):
        options.seconds = 60.0
    logging.disable(logging.CRITICAL)
    atheris = None if options.plain else _atheris()
    target = _load(options.target, atheris)
    if atheris is not None:
        return _run_guided(atheris, target, options)
    limits = Limits(options.runs, options.seconds, options.growth)
    return run_plain(target, limits, random.Random(options.seed))


def _atheris() -> Any | None:
    try:
        return importlib.import_module("atheris")
    except ImportError:
        print("atheris is not installed (pip install atheris): plain random inputs")
        return None


def _load(name: str, atheris: Any | None) -> ModuleType:
    sys.path.insert(0, str(HERE))
    instrumented = nullcontext() if atheris is None else atheris.instrument_imports()
    with instrumented:
        return importlib.import_module(f"targets.{name}")


def _seeds(target: ModuleType) -> list[bytes]:
    return list(target.seeds()) if hasattr(target, "seeds") else [b""]


def _run_guided(atheris: Any, target: ModuleType, options: argparse.Namespace) -> int:
    """Hands over to libFuzzer, which ends the process itself: 0 nothing found, 77 found."""
    with tempfile.TemporaryDirectory() as corpus:
        for index, seed in enumerate(_seeds(target)):
            Path(corpus, f"seed-{index}").write_bytes(seed)
        arguments = [
            sys.argv[0],
            f"-seed={options.seed or 1}",
            f"-max_total_time={int(options.seconds)}",
            f"-runs={options.runs or -1}",
            f"-artifact_prefix={HERE}/found-",
            "-print_final_stats=1",
            corpus,
        ]
        atheris.Setup(arguments, target.one_input)
        atheris.Fuzz()
    return EXIT_OK


def run_plain(target: ModuleType, limits: Limits, numbers: random.Random) -> int:
    """Feeds random and mutated inputs and tells what they cost.

    Args:
        target: The module of the target.
        limits: When to end, and the memory that may be added.
        numbers: Where all randomness comes from.
    """
    seeds, one_input = _seeds(target), target.one_input
    begin = time.monotonic()
    count, warm = 0, 0.0
    while not _is_over(limits, count, begin):
        data = make_input(seeds, numbers)
        try:
            one_input(data)
        except Exception:
            return _tell_found(target, data, count)
        count += 1
        if not warm and _progress(limits, count, begin) >= _WARM_UP_SHARE:
            warm = _memory_mib()
    growth = _memory_mib() - (warm or _memory_mib())
    seconds = time.monotonic() - begin
    print(f"{count} inputs in {seconds:.1f} s, nothing found; memory grew by {growth:.1f} MiB")
    if hasattr(target, "report"):
        print(target.report())
    if growth > limits.growth_mib:
        print(f"memory grew by more than {limits.growth_mib} MiB")
        return EXIT_FOUND
    return EXIT_OK


def _progress(limits: Limits, count: int, begin: float) -> float:
    by_count = count / limits.runs if limits.runs else 0.0
    if not limits.seconds or count % _CLOCK_EVERY:
        return by_count
    return max(by_count, (time.monotonic() - begin) / limits.seconds)


def _is_over(limits: Limits, count: int, begin: float) -> bool:
    return _progress(limits, count, begin) >= 1


def _memory_mib() -> float:
    """Returns the most memory that the process has had."""
    try:
        # That of getrusage counts the process that started this one, too, on Linux.
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
    line = next(line for line in status.splitlines() if line.startswith("VmHWM:"))
    return int(line.split()[1]) / (1 << 10)


def _tell_found(target: ModuleType, data: bytes, count: int) -> int:
    name = f"found-{hashlib.sha256(data).hexdigest()[:16]}"
    (HERE / name).write_bytes(data)
    traceback.print_exc()
    print(f"{target.__name__}: input {count} raised; it is kept in fuzz/{name}: {data.hex()}")
    return EXIT_FOUND


def make_input(seeds: Sequence[bytes], numbers: random.Random) -> bytes:
    """Returns random bytes, or a seed with a few mutations.

    Args:
        seeds: Inputs to begin with.
        numbers: Where all randomness comes from.
    """
    if numbers.random() < _RANDOM_SHARE:
        return numbers.randbytes(numbers.randrange(_LONGEST_RANDOM))
    data = bytearray(numbers.choice(seeds))
    for _ in range(numbers.randrange(_MOST_MUTATIONS + 1)):
        numbers.choice(_MUTATIONS)(data, seeds, numbers)
    return bytes(data)


def _flip(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    if data:
        data[numbers.randrange(len(data))] ^= 1 << numbers.randrange(8)


def _replace(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    if data:
        data[numbers.randrange(len(data))] = numbers.randrange(256)


def _replace_interesting(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    if data:
        data[numbers.randrange(len(data))] = numbers.choice(_INTERESTING)


def _insert(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    place = numbers.randrange(len(data) + 1)
    data[place:place] = numbers.randbytes(numbers.randrange(1, 8))


def _delete(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    place = numbers.randrange(len(data) + 1)
    del data[place : place + numbers.randrange(1, 8)]


def _cut(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    del data[numbers.randrange(len(data) + 1) :]


def _repeat(data: bytearray, _seeds: Sequence[bytes], numbers: random.Random) -> None:
    if len(data) < 1 << 12:
        place = numbers.randrange(len(data) + 1)
        data += data[place:]


def _splice(data: bytearray, seeds: Sequence[bytes], numbers: random.Random) -> None:
    other = numbers.choice(seeds)
    place = numbers.randrange(len(data) + 1)
    data[place:] = other[numbers.randrange(len(other) + 1) :]


_MUTATIONS: tuple[Callable[[bytearray, Sequence[bytes], random.Random], None], ...] = (
    _flip,
    _replace,
    _replace,
    _replace_interesting,
    _insert,
    _delete,
    _cut,
    _repeat,
    _splice,
)


if __name__ == "__main__":
    sys.exit(main())
