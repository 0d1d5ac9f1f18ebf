"""Importer of ROS 2 interface definitions: .msg, .srv and .action files."""

from jausml.language.importers.ros.building import ROS_RULES
from jausml.language.importers.ros.importing import ImportResult, import_packages, placed
from jausml.language.importers.ros.sources import (
    InterfaceFile,
    PackageSource,
    installed_source,
    package_sources,
)

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
