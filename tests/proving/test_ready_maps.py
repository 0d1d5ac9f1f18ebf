"""Proofs of ready maps of each kind find no fault, and both forms agree; `make proofs` has all."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from jausml.generation.native import compiler
from jausml.language.model import library_root
from jausml.language.validation.engine import check_project
from jausml.proving.compiled_form import CompiledForm, compiled, proof_code
from jausml.proving.plan import plan
from jausml.proving.results import PROOF_RULES, MapResult, with_proofs
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, prove

POWER_PLANT = library_root() / "mappings" / "power_plant.ros2jaus"

GUARDS = ("generators/jausml_generators/cpp", "models/library/mappings")

pytestmark = [pytest.mark.needs("compiler"), pytest.mark.slow, pytest.mark.timeout(600)]


def proved(path: Path, names: Sequence[str] = ()) -> list[MapResult]:
    """Results of maps of a file, in which nothing falls short."""
    report = check_project([path])
    maps = [trip for trip in round_trips(report.model) if not names or trip.name in names]
    assert maps, path
    results = list(prove(report.model, maps, Settings(str(compiler()), 0.01, 2)))
    judged = with_proofs(report, maps, results)
    assert not [finding.message for finding in judged.diagnostics if finding.rule in PROOF_RULES]
    for result in results:
        assert result.fields, (result.name, result.remarks)
        for one in result.fields:
            assert one.tried, (result.name, one.path)
            assert not one.faults
            assert not one.differing
    return results


def test_joined_reports_and_topics_take_all_values():
    (odometry,) = proved(library_root() / "mappings/odometry.ros2jaus")
    for name in ("Velocity_X", "Velocity_Y", "Velocity_Z", "RollRate", "PitchRate", "YawRate"):
        rate = odometry.find("JAUS", f"velocity.{name}")
        assert rate is not None
        assert rate.tried == rate.unchanged == 65536, name
    assert rate.reached[0].path == "twist.twist.angular.z"
    hour = odometry.find("JAUS", "TimeStamp.Hour")
    assert hour is not None
    assert (hour.unchanged, hour.refused) == (24, 8)
    (lamps,) = proved(library_root() / "mappings/illumination.ros2jaus", ["set_lamps"])
    assert {field.path: field.tried for field in lamps.fields}["fog_lights.data"] == 2


def test_lists_have_the_elements_that_a_map_wants():
    path = library_root() / "mappings/joint_positions.ros2jaus"
    (found,) = proved(path, ["joint_positions"])
    for joint in range(6):
        angle = found.find("JAUS", f"JointPositionList[{joint}].JointPosition.radian")
        assert angle is not None
        assert angle.unchanged == angle.tried == 65536


def test_an_integer_of_which_one_value_counts_is_carried():
    path = library_root() / "mappings/visual_sensor.ros2jaus"
    (found,) = proved(path, ["visual_sensor_switched"])
    (sensor,) = found.fields  # of one of the options of a variant
    assert sensor.path == "ConfirmSensorList[0].SensorIdRec.SensorID"
    assert [reached.path for reached in sensor.reached] == ["success"]


def test_a_map_that_is_left_to_python_is_called_so():
    report = check_project([library_root() / "mappings/cost_map_2d.ros2jaus"])
    maps = [trip for trip in round_trips(report.model) if trip.name == "cost_map"]
    (found,) = prove(report.model, maps, Settings(str(compiler()), 0.01, 1))
    assert not found.fields
    assert [remark.partition(": ")[0] for remark in found.remarks] == ["left to Python"] * 2


def test_a_variant_takes_the_option_of_which_most_comes_back(monkeypatch, tmp_path):
    (found,) = proved(POWER_PLANT, ["battery"])
    path = "powerPlantStatusList[0].powerPlantStatusVar.batteryStatus[0].voltage"
    voltage = found.find("JAUS", path)
    assert voltage is not None
    assert voltage.unchanged == 65536
    assert not [remark for remark in found.remarks if "not tried" in remark]

    # Options that are not tried are told.
    monkeypatch.setattr("jausml.proving.plan._OPTIONS", 1)
    model = check_project([POWER_PLANT]).model
    (trip,) = (trip for trip in round_trips(model) if trip.name == "battery")
    code = proof_code(model, trip)
    with CompiledForm(compiled(code, tmp_path, str(compiler()))) as form:
        assert "JAUS: options behind the first 1 are not tried" in plan(code, form, trip).remarks
