"""Installs the package in a ROS 2 workspace."""

from setuptools import setup

setup(
    name="catvehicle",
    version="0.1.0",
    packages=["catvehicle"],
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/catvehicle"]),
        ("share/catvehicle", ["package.xml"]),
    ],
)
