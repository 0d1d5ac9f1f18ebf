"""Changes of the lists of other components, by several threads at once."""

import sys
from queue import SimpleQueue
from threading import Thread

import pytest

from jausml.live.peers.operator import running_operator
from jausml.live.peers.query_client import Refused
from jausml.runtime.base.address import JausAddress

pytestmark = pytest.mark.ports

SILENT = JausAddress(100, 1, 1)


def test_of_two_changes_at_once_one_is_refused_and_the_other_can_be_dropped(
    network, catalogue, wait_until
):
    outcomes = SimpleQueue()

    def change():
        with pytest.raises(Refused) as refused:
            operator.set_list(SILENT, [b"\x0d\x04\x00"])
        outcomes.put(str(refused.value))

    with running_operator(network, catalogue) as operator:
        threads = [Thread(target=change) for _ in range(2)]
        with operator._component.loop.lock:  # both have got as far as they can without the other
            for thread in threads:
                thread.start()
            wait_until(lambda: all(waits_in_set_list(thread) for thread in threads))
        assert outcomes.get(timeout=10) == "the list of 100.1.1 is being changed"
        operator.drop_list_changes()
        assert outcomes.get(timeout=10) == (
            "100.1.1 does not take the list: it was stopped meanwhile"
        )
        for thread in threads:
            thread.join()


def waits_in_set_list(thread):
    frame = sys._current_frames().get(thread.ident)
    return frame is not None and frame.f_code.co_name == "set_list"
