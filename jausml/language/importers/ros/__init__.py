"""Importer of ROS 2 interface definitions: .msg, .srv and .action files."""

from jausml.language.importers.ros.definitions import ROS_RULES as ROS_RULES
from jausml.language.importers.ros.definitions import InterfaceFile as InterfaceFile
from jausml.language.importers.ros.definitions import PackageSource as PackageSource
from jausml.language.importers.ros.definitions import installed_source as installed_source
from jausml.language.importers.ros.definitions import package_sources as package_sources
from jausml.language.importers.ros.importing import ImportResult as ImportResult
from jausml.language.importers.ros.importing import import_packages as import_packages
from jausml.language.importers.ros.importing import placed as placed
