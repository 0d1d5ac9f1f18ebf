"""Clocks of processes as they are after the computer was suspended, which no test can do.

While a computer is suspended `CLOCK_MONOTONIC` rests, and `CLOCK_BOOTTIME` goes on. A library that
processes load first adds to the latter what a file says.
"""

import os
import struct
import subprocess
import sys
from pathlib import Path

_SOURCE = r"""
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <ctime>

using Read = int (*)(clockid_t, timespec*);

static const volatile std::int64_t* suspended() {
    static const auto found = [] {
        const int file = open(getenv("SUSPENDED_CLOCKS"), O_RDONLY);
        void* const memory = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
        return memory == MAP_FAILED ? nullptr : static_cast<const std::int64_t*>(memory);
    }();
    return found;
}

extern "C" int clock_gettime(clockid_t clock, timespec* now) noexcept {
    static const auto read = reinterpret_cast<Read>(dlsym(RTLD_NEXT, "clock_gettime"));
    const int result = read(clock, now);
    const bool goes_on = result == 0 && clock == CLOCK_BOOTTIME && suspended() != nullptr;
    if (goes_on) now->tv_sec += *suspended();
    return result;
}
"""


class SuspendedClocks:
    """The clocks of all processes that are started with `environment`."""

    def __init__(self, folder: Path, compiler: str) -> None:
        """Compiles the library; nothing was suspended yet."""
        source, library = folder / "clocks.cpp", folder / "clocks.so"
        source.write_text(_SOURCE, encoding="utf-8")
        subprocess.run(
            [compiler, "-std=c++17", "-O1", "-fPIC", "-shared", "-o", library, source, "-ldl"],
            check=True,
        )
        self._file = folder / "suspended"
        self.suspend(0)
        self.environment = {"LD_PRELOAD": str(library), "SUSPENDED_CLOCKS": str(self._file)}

    def told(self, code: str, seconds: int) -> str:
        """What a program says that prints a line, is suspended, and reads one before it goes on."""
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        line, environment = [sys.executable, "-c", code], {**os.environ, **self.environment}
        with subprocess.Popen(line, env=environment, **pipes) as process:
            begin = process.stdout.readline()
            self.suspend(seconds)
            rest, _ = process.communicate("\n")
        return begin + rest

    def suspend(self, seconds: int) -> None:
        """Says for how many seconds the computer was suspended since the processes began."""
        descriptor = os.open(self._file, os.O_WRONLY | os.O_CREAT)
        os.pwrite(descriptor, struct.pack("=q", seconds), 0)
        os.close(descriptor)
