"""What is remembered of the quirks of peers."""

import logging

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.quirks import MAX_PEERS, Quirk, Quirks

PEER = JausAddress(152, 1, 1)


def test_a_quirk_is_known_by_name_with_what_showed_it_and_what_is_done(caplog):
    caplog.set_level(logging.INFO)
    quirks = Quirks()
    assert quirks.of(PEER) == ()
    assert not quirks.has(PEER, Quirk.OTHER_VERSION)
    quirks.learn(PEER, Quirk.NO_WILDCARDS, "nothing was reported")
    quirks.learn(PEER, Quirk.OTHER_VERSION, "no version")
    quirks.learn(PEER, Quirk.OTHER_VERSION, "no version")
    assert [observation.quirk for observation in quirks.of(PEER)] == [
        Quirk.OTHER_VERSION,
        Quirk.NO_WILDCARDS,
    ]
    told = (
        "acknowledges without the version of JUDP (no version): "
        "an acknowledgement counts where a packet waits for it"
    )
    assert str(quirks.of(PEER)[0]) == told
    assert [record.message for record in caplog.records].count(f"152.1.1 {told}") == 1


def test_invented_peers_fill_neither_the_memory_nor_the_log(caplog):
    caplog.set_level(logging.INFO)
    quirks = Quirks()
    strangers = [JausAddress(number, 1, 1) for number in range(1, 2 * MAX_PEERS)]
    for stranger in strangers:
        quirks.learn(stranger, Quirk.OTHER_VERSION, "no version")
    assert len(caplog.records) == MAX_PEERS
    assert sum(bool(quirks.of(stranger)) for stranger in strangers) == MAX_PEERS
    assert quirks.of(strangers[-1])
