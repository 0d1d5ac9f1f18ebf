"""A camera on the network: a real server of HTTP with Motion JPEG, and answers that are none."""

from __future__ import annotations

import struct
import threading
import zlib
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

MIXED = "multipart/x-mixed-replace; boundary=frame"


def png(size):
    """A picture with a corner that is dark, made by the standard of the format (ISO/IEC 15948)."""

    def chunk(kind, data):
        check = struct.pack(">I", zlib.crc32(kind + data))
        return struct.pack(">I", len(data)) + kind + data + check

    rows = [b"\0" + bytes(255 if x + y > size else 60 for x in range(size)) for y in range(size)]
    header = struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(b"".join(rows))), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*each) for each in parts)


class CameraServer:
    """What was asked, and who still looks.

    Attributes:
        asked: The paths, in their order.
        looking: How many streams are being sent.
        files: Type and bytes of what else is served, by path; a video goes on, as that of a camera.
    """

    def __init__(self, server):
        self.port = server.server_address[1]
        self.host = f"127.0.0.1:{self.port}"
        self.asked, self.looking = [], 0
        self.files = {
            "/page": ("text/html", png(40)),
            "/drawing": ("image/svg+xml", png(40)),
            "/one": ("image/png", png(40)),
        }

    def url(self, path):
        return f"http://{self.host}{path}"


def give(handler, end, kind, body):
    """Answers with some bytes; a video goes on until the end."""
    goes_on = kind == "video/webm"
    handler.send_response(200)
    handler.send_header("Content-Type", kind)
    if not goes_on:
        handler.send_header("Content-Length", str(len(body)))
    handler.end_headers()
    handler.wfile.write(body)
    if goes_on:
        end.wait()


def _answered(camera, end):
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            camera.asked.append(self.path)
            if self.path == "/moved":
                self.send_response(302)
                self.send_header("Location", "/mjpeg")
                self.end_headers()
            elif self.path in camera.files:
                give(self, end, *camera.files[self.path])
            elif self.path.startswith("/mjpeg"):
                self._stream()
            else:
                self.send_error(404)

        def _stream(self):
            self.send_response(200)
            self.send_header("Content-Type", MIXED)
            self.end_headers()
            picture = png(120)
            head = f"--frame\r\nContent-Type: image/png\r\nContent-Length: {len(picture)}\r\n\r\n"
            camera.looking += 1
            try:
                while not end.wait(0.05):
                    self.wfile.write(head.encode() + picture + b"\r\n")
            except OSError:
                pass
            finally:
                camera.looking -= 1

        def log_message(self, *_):
            """Says nothing."""

    return Handler


@contextmanager
def serving_camera():
    """A server on this computer alone."""
    end = threading.Event()
    server = ThreadingHTTPServer(("127.0.0.1", 0), BaseHTTPRequestHandler)
    camera = CameraServer(server)
    server.RequestHandlerClass = _answered(camera, end)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield camera
    finally:
        end.set()
        server.shutdown()
        server.server_close()
        thread.join()


def register(registrar, component, urls):
    """Has a component tell addresses, as a device that registers them (IOP)."""
    for url in urls:
        told = {"ServerType": 0, "ServerURL": url}
        fields = {"DigitalResourceEndpointRec": told}
        registrar.request(component, "RegisterDigitalResourceEndpoint", fields)
