"""A real RTSP server (GStreamer) with a test picture at /front, for the Python of the distribution.

Arguments: its port, width and height. Prints a line when it serves.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer

Gst.init(None)
port, width, height = sys.argv[1:]
server = GstRtspServer.RTSPServer(address="127.0.0.1", service=port)
factory = GstRtspServer.RTSPMediaFactory()
factory.set_launch(
    "( videotestsrc is-live=true !"
    f" video/x-raw,format=I420,width={width},height={height},framerate=20/1"
    " ! jpegenc ! rtpjpegpay name=pay0 )"
)
server.get_mount_points().add_factory("/front", factory)
if server.attach(None) == 0:
    sys.exit(f"port {port} is taken")
sys.stdout.write("serving\n")
sys.stdout.flush()
GLib.MainLoop().run()
