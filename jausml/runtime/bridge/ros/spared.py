"""What a bridge keeps out of its process until somebody asks for it.

The modules of messages import numpy, and rclpy imports yaml; a bridge uses neither, and both with
what generates Python of ROS types take a quarter of the memory of its process.
"""

from __future__ import annotations

import sys
import threading
from contextlib import suppress
from importlib import import_module
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import Any

SPARED = ("numpy", "yaml")
"""Modules that are imported when something of them is asked for."""

_TYPE_SUPPORTS = "rosidl_generator_py"
_GENERATING = f"{_TYPE_SUPPORTS}.generate_py_impl"

_LOCK = threading.RLock()
"""Held by the thread that imports: a module may be executed only once."""


class SparedModule(ModuleType):
    """Stands for a module until something of it is asked for."""

    def __init__(self, spec: ModuleSpec) -> None:
        super().__init__(spec.name)
        self.__spec__ = spec
        # Who looks for the module of a function asks all modules for their files.
        self.__file__ = spec.origin

    def __getattr__(self, name: str) -> Any:
        """Imports the module, and is as it is from then on."""
        with _LOCK:
            if sys.modules.get(self.__name__) is self:
                del sys.modules[self.__name__]
            module = import_module(self.__name__)
            self.__dict__.update(module.__dict__)
        return getattr(module, name)


def spare_modules() -> None:
    """Keeps modules that nobody may use out of the process, before rclpy and messages ask for them.

    Whoever imports them afterwards, as overrides may, finds all that they have.
    """
    for name in SPARED:
        spec = None if name in sys.modules else find_spec(name)
        if spec is not None:
            sys.modules[name] = SparedModule(spec)
    _spare_generator()


def _spare_generator() -> None:
    """Keeps out of the process what generates Python of ROS types, which takes 8 MiB.

    It comes with the package that finds type supports, which is prepared to do without.
    """
    if _TYPE_SUPPORTS in sys.modules or _GENERATING in sys.modules:
        return
    sys.modules[_GENERATING] = None  # type: ignore[assignment]  # so its import fails
    try:
        with suppress(ImportError):
            import_module(_TYPE_SUPPORTS)
    finally:
        del sys.modules[_GENERATING]
