"""A program that another process has imported: hands over what it was started with, and its fate.

It is started once for each command, and imports little.
"""

import json
import os
import signal
import socket
import sys

PASSED_ON = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


def main(address: str) -> None:
    """Has a command done, and ends as it does."""
    ignored = [signals for signals in PASSED_ON if signal.getsignal(signals) is signal.SIG_IGN]
    request = {
        "program": address.rpartition("/")[2],
        "arguments": sys.argv[1:],
        "folder": os.getcwd(),  # noqa: PTH109 - pathlib takes as long as the rest
        "environment": dict(os.environ),
        "ignored": ignored,
    }
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as server:
        signal.pthread_sigmask(signal.SIG_BLOCK, PASSED_ON)
        server.connect(address)
        socket.send_fds(server, [b"\0"], [0, 1, 2])
        server.sendall(json.dumps(request).encode() + b"\n")
        answers = server.makefile("r")
        child = int(answers.readline())
        for signals in PASSED_ON:  # those too that are ignored until the command takes them
            signal.signal(signals, lambda number, _: os.kill(child, number))
        signal.pthread_sigmask(signal.SIG_UNBLOCK, PASSED_ON)
        status = os.waitstatus_to_exitcode(int(answers.readline()))
    if status < 0:
        signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    sys.exit(status)


main(sys.argv.pop(1))
