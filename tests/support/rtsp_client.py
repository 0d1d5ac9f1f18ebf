"""A real RTSP client (GStreamer), for the Python of the distribution.

Arguments: a URL, and how many pictures to take. Prints width and height of each as it comes.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst

Gst.init(None)
pipeline = Gst.parse_launch(
    "rtspsrc name=source protocols=tcp ! rtpjpegdepay ! jpegdec ! appsink name=sink sync=false"
)
pipeline.get_by_name("source").set_property("location", sys.argv[1])
sink = pipeline.get_by_name("sink")
pipeline.set_state(Gst.State.PLAYING)
for _ in range(int(sys.argv[2])):
    sample = sink.emit("try-pull-sample", 20 * Gst.SECOND)
    if sample is None:
        message = pipeline.get_bus().pop_filtered(Gst.MessageType.ERROR)
        sys.exit(str(message.parse_error()) if message else "no picture came")
    picture = sample.get_caps().get_structure(0)
    size = picture.get_value("width"), picture.get_value("height")
    sys.stdout.write("{} {}\n".format(*size))
    sys.stdout.flush()
pipeline.set_state(Gst.State.NULL)
