"""A small client of the language server protocol, over the pipes of a process."""

import json
import subprocess
import sys


class Client:
    """Starts the server and speaks with it.

    Args:
        folder: The folder in which the server runs.
    """

    def __init__(self, folder):
        command = [sys.executable, "-m", "jausml", "language-server"]
        self._process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._id = 0
        self._published = []
        self.capabilities = self.ask("initialize", processId=None, rootUri=None, capabilities={})
        self.tell("initialized")

    def ask(self, method, **params):
        """Sends a request and returns its result; one that is refused raises."""
        self._id += 1
        self._send(id=self._id, method=method, params=params)
        while True:
            message = self._receive()
            if message.get("id") == self._id and "method" not in message:
                if "error" in message:
                    raise ValueError(message["error"]["message"])
                return message["result"]

    def tell(self, method, **params):
        """Sends a notification."""
        self._send(method=method, params=params)

    def problems(self, uri, version, *, some=False):
        """Returns the next problems published for a version of a text; with `some`, not none."""
        while True:
            for notification in self._published:
                is_meant = (notification["uri"], notification.get("version")) == (uri, version)
                if is_meant and (notification["diagnostics"] or not some):
                    self._published.remove(notification)
                    return notification["diagnostics"]
            self._receive()

    def end(self):
        """Ends the session and returns the exit status."""
        self._send(id="end", method="shutdown")
        while self._receive().get("id") != "end":
            pass
        self._send(method="exit")
        self._process.stdin.close()
        status = self._process.wait(30)
        self._process.stdout.close()
        return status

    def _send(self, **message):
        data = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(data), data))
        self._process.stdin.flush()

    def _receive(self):
        length = 0
        while (line := self._process.stdout.readline()) != b"\r\n":
            if not line:
                raise EOFError("the server has gone")
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                length = int(value)
        message = json.loads(self._process.stdout.read(length))
        if message.get("method") == "textDocument/publishDiagnostics":
            self._published.append(message["params"])
        return message
