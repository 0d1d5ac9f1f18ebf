"""Start of a worker's process: it can import the runtime and the generated packages.

It is run by its path, with the folder of the runtime, that of the generated workspace, and the
script that goes on, with its command line.
"""

from __future__ import annotations

import importlib.util
import runpy
import sys
from pathlib import Path


def load_runtime(folder: Path) -> None:
    """Loads the runtime from a folder under the name that generated code knows."""
    spec = importlib.util.spec_from_file_location(
        "jausml_runtime", folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    if spec is None or spec.loader is None:
        raise ImportError(f"no runtime in {folder}")
    module = importlib.util.module_from_spec(spec)
    sys.modules["jausml_runtime"] = module
    spec.loader.exec_module(module)


def main() -> None:
    """Runs the script."""
    runtime, workspace, script = map(Path, sys.argv[1:4])
    load_runtime(runtime)
    sys.path[:0] = [str(path) for path in sorted(workspace.iterdir()) if path.is_dir()]
    sys.argv[:] = [str(script), *sys.argv[4:]]
    runpy.run_path(str(script), run_name="__main__")


if __name__ == "__main__":
    main()
