"""How fast the reader is: `python benchmarks/read_models.py [ELEMENTS...]`.

For each size it writes a service set and a bridge that refers into it, both valid, then reads the
bridge in a fresh process and prints what the whole process took.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ELEMENTS_PER_SERVICE = 11
REFERENCES_EACH = 10

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<{tag} xmi:version="2.0"'
    ' xmlns:xmi="http://www.omg.org/XMI" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    ' xmlns:jaus="http://www.jausml.org/jaus/1.0" {attributes}>\n'
)
_SERVICE = """  <services name="S{n}" urn="urn:example:S{n}" version="1.0" {inherits}>
    <inputs name="Set{n}" code="0x{code:04X}" isCommand="true">
      <body xsi:type="jaus:Record" name="Body" presenceVector="uint8">
        <fields xsi:type="jaus:FixedField" name="X" optional="true" type="uint16" units="meter">
          <scale lower="-100.0" upper="100.0"/>
        </fields>
        <fields xsi:type="jaus:FixedField" name="Y" optional="true" type="uint16" units="meter"/>
        <fields xsi:type="jaus:FixedField" name="Z" optional="true" type="uint16" units="meter"/>
      </body>
    </inputs>
    <outputs name="Report{n}" code="0x{code:04X}">
      <body xsi:type="jaus:Record" name="Body">
        <fields xsi:type="jaus:FixedField" name="State" type="uint8"/>
      </body>
    </outputs>
  </services>
"""
_READ = """
import resource, sys
from jausml.language.model import read_models
result = read_models([sys.argv[1]])
assert not result.has_errors, result.diagnostics[:3]
elements = sum(1 for _ in result.model.elements())
print(elements, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


def write_models(folder: Path, elements: int) -> Path:
    """Writes a service set of about so many elements and a component that refers to it.

    Args:
        folder: Where to write.
        elements: Number of elements of the service set.

    Returns:
        The file of the component.
    """
    services = max(elements // ELEMENTS_PER_SERVICE, 1)
    with (folder / "services.xmi").open("w", encoding="utf-8") as file:
        file.write(_HEAD.format(tag="jaus:ServiceSet", attributes='name="Big"'))
        for n in range(services):
            inherits = f'inherits="//@services.{n - 1}"' if n else ""
            file.write(_SERVICE.format(n=n, code=n % 0x10000, inherits=inherits))
        file.write("</jaus:ServiceSet>\n")
    component = folder / "component.xmi"
    with component.open("w", encoding="utf-8") as file:
        file.write(_HEAD.format(tag="jaus:Component", attributes='name="c" address="1.1.1"'))
        for n in range(0, services, REFERENCES_EACH):
            file.write(f'  <provides href="services.xmi#//@services.{n}"/>\n')
        file.write("</jaus:Component>\n")
    return component


def measure(command: list[str], runs: int) -> tuple[float, str]:
    """Returns the median wall-clock time of a process, and what it printed."""
    times = []
    output = ""
    for _ in range(runs):
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, *command], check=False, capture_output=True, text=True
        )
        times.append(time.perf_counter() - start)
        # 1: the services repeat message codes along their inheritance, which rules report.
        assert done.returncode in (0, 1), done.stderr
        output = done.stdout
    return statistics.median(times), output


def main() -> None:
    """Prints one line for each size."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("elements", nargs="*", type=int, default=[10, 1_000, 10_000, 100_000])
    parser.add_argument("--runs", type=int, default=3, help="runs for each size")
    arguments = parser.parse_args()
    print("elements   read, whole process   peak memory   jausml validate, whole process")
    for elements in arguments.elements:
        with tempfile.TemporaryDirectory() as folder:
            model = str(write_models(Path(folder), elements))
            seconds, output = measure(["-c", _READ, model], arguments.runs)
            verb = ["-m", "jausml", "validate", "--quiet", folder]
            judged, _ = measure(verb, arguments.runs)
        count, memory = output.split()
        print(f"{int(count):8d}   {seconds:17.2f} s   {memory:>8} MiB   {judged:10.2f} s")


if __name__ == "__main__":
    main()
