"""Types of messages that have changed since they were recorded: never read by their bytes alone."""

from __future__ import annotations

import struct

import pytest
from click.testing import CliRunner
from mcap.writer import Writer
from ports import free_port

from jausml.cli import main
from jausml.language.interfaces import parse_definition
from jausml.live.recording.mcap_reading import UNDEFINED, RecordedDefinition
from jausml.live.recording.recorded_types import RecordedTypes
from jausml.model import load_model

SECOND = 10**9
MODEL = """drive {
    JAUS ReportDrive ( float64 speed  float64 turn ) { code: 0xD501 }
    ROS drive_msgs/Drive ( float64 speed  float64 turn  Leg leg )
    ROS drive_msgs/Leg ( uint8[] parts  string<=8 name )
    ROS->JAUS ( speed -> speed  turn -> turn )
}
bridge b { address: 100.1.9  provides: Drives
  connection d { map: drive direction: rosToJaus exchange: everyChangeEvent topic /drive }
}
"""
LINE = "=" * 80
LEG = f"{LINE}\nMSG: drive_msgs/Leg\n"
RECORDED = f"float64 speed\nfloat64 turn\nLeg leg\n{LEG}uint8[] parts\nstring name\n"
