"""Delays imports of ROS that a bridge does not need.

Modules of ROS messages import numpy, and rclpy imports yaml; a bridge uses neither. With the
generator of Python for ROS types they take a quarter of the memory of its process.
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

SPARED = ("numpy", "yaml")  # modules that are imported at the first use of an attribute
_TYPE_SUPPORTS = "rosidl_generator_py"
_GENERATING = f"{_TYPE_SUPPORTS}.generate_py_impl"

_LOCK = threading.RLock()  # held by the thread that imports, as a module is executed once


class SparedModule(ModuleType):
    """Stands for a module until its first attribute is used."""

    def __init__(self, spec: ModuleSpec) -> None:
        super().__init__(spec.name)
        self.__spec__ = spec
        # `inspect` reads the file of each module.
        self.__file__ = spec.origin

    def __getattr__(self, name: str) -> Any:
        """Imports the module, takes over all its attributes, and returns one."""
        with _LOCK:
            if sys.modules.get(self.__name__) is self:
                del sys.modules[self.__name__]
            module = import_module(self.__name__)
            self.__dict__.update(module.__dict__)
        return getattr(module, name)


def spare_modules() -> None:
    """Delays the modules; to be called before rclpy and messages are imported.

    An override that imports one of them later can use it as usual.
    """
    for name in SPARED:
        spec = None if name in sys.modules else find_spec(name)
        if spec is not None:
            sys.modules[name] = SparedModule(spec)
    _spare_generator()


def _spare_generator() -> None:
    """Imports the package of type supports without its generator, which takes 8 MiB.

    That package handles the ImportError.
    """
    if _TYPE_SUPPORTS in sys.modules or _GENERATING in sys.modules:
        return
    sys.modules[_GENERATING] = None  # type: ignore[assignment]  # so its import fails
    try:
        with suppress(ImportError):
            import_module(_TYPE_SUPPORTS)
    finally:
        del sys.modules[_GENERATING]
