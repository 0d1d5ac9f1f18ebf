import argparse

import pytest

from jausml.runtime import ComponentSettings
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import (
    TransportKind,
    TransportSettings,
    add_arguments,
    from_arguments,
    peers,
)
from jausml.runtime.component.process import add_component_arguments, component_settings


def parse(*words: str, defaults: TransportSettings | None = None) -> TransportSettings:
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_arguments(parser, defaults)
    return from_arguments(parser.parse_args(words), defaults)


def test_without_options_the_standard_applies():
    assert parse() == TransportSettings()
    settings = TransportSettings()
    assert (settings.port, settings.multicast_group, settings.multicast_ttl) == (
        3794,
        "239.255.0.1",
        16,
    )


def test_options_override_modelled_settings_and_extend_the_address_book():
    modelled = TransportSettings(
        port=4000, fragment_size=1000, address_book={JausAddress(1, 1, 1): ("robot", 4000)}
    )
    settings = parse(
        "--jaus-interface=192.0.2.7",
        "--jaus-multicast-ttl=1",
        "--jaus-fragment-size=1400",
        "--jaus-peer=2.1.1=192.0.2.8:3794",
        "--jaus-peer=3.1.1=driver.local:4001",
        defaults=modelled,
    )
    assert settings.interface == "192.0.2.7"
    assert (settings.port, settings.fragment_size, settings.multicast_ttl) == (4000, 1400, 1)
    assert settings.address_book == {
        JausAddress(1, 1, 1): ("robot", 4000),
        JausAddress(2, 1, 1): ("192.0.2.8", 3794),
        JausAddress(3, 1, 1): ("driver.local", 4001),
    }


@pytest.mark.parametrize("kind", list(TransportKind))
def test_the_transport_is_chosen_by_option_and_by_model(kind):
    folder = "--jaus-node-manager-directory=/run/jaus"
    chosen = TransportSettings(transport=kind, node_manager_directory="/run/jaus")
    assert parse(f"--jaus-transport={kind.value}", folder) == chosen
    assert parse(defaults=chosen) == chosen


def test_peers_are_written_as_on_the_command_line():
    known = peers("1.1.1=192.0.2.7:3794", "2.1.1=robot.local:4000")
    assert known == {
        JausAddress(1, 1, 1): ("192.0.2.7", 3794),
        JausAddress(2, 1, 1): ("robot.local", 4000),
    }


BAD_PEERS = ("", "1.1.1", "1.1.1=host", "1.1.1=:5", "1.1.1=host:x", "1.1=host:5", "=host:5")


@pytest.mark.parametrize(
    ("option", "text"), [("transport", "carrier-pigeon"), *(("peer", text) for text in BAD_PEERS)]
)
def test_an_unknown_transport_and_a_bad_peer_are_usage_errors(option, text):
    with pytest.raises(argparse.ArgumentError, match=f"jaus-{option}"):
        parse(f"--jaus-{option}={text}")


@pytest.mark.parametrize(
    "values",
    [
        {"interface": "0.0.0.0"},  # noqa: S104
        {"interface": "239.255.0.1"},
        {"interface": "eth0"},
        {"multicast_group": "10.0.0.1"},
        {"port": 0},
        {"port": 65536},
        {"multicast_ttl": 256},
        {"multicast_ttl": -1},
        {"fragment_size": 1},
        {"fragment_size": 4080},
        {"acknowledge_retries": -1},
        {"acknowledge_timeout": 0.0},
        {"send_buffer": -1},
        {"connection_timeout": 0.0},
        {"address_book": {JausAddress(1, 1, 255): ("127.0.0.1", 3794)}},
        {"address_book": {JausAddress(1, 1, 1): ("127.0.0.1", 0)}},
    ],
)
def test_values_out_of_range_are_refused(values):
    with pytest.raises(ValueError, match=r"\S"):
        TransportSettings(**values)


def test_control_survives_an_emergency_by_option():
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_component_arguments(parser, JausAddress(1, 1, 1))
    modelled = ComponentSettings(control_timeout=2)
    assert component_settings(parser.parse_args([]), modelled) == modelled
    settings = component_settings(parser.parse_args(["--control-survives-emergency"]), modelled)
    assert settings == ComponentSettings(control_timeout=2, control_survives_emergency=True)
