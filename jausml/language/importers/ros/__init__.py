"""Importer of ROS 2 interface definitions: .msg, .srv and .action files."""

from jausml.language.importers.ros.definitions import (
    ROS_RULES,
    InterfaceFile,
    PackageSource,
    installed_source,
    package_sources,
)
from jausml.language.importers.ros.importing import ImportResult, import_packages, placed

__all__ = [
    "ROS_RULES",
    "ImportResult",
    "InterfaceFile",
    "PackageSource",
    "import_packages",
    "installed_source",
    "package_sources",
    "placed",
]
