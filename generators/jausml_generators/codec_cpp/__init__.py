"""Target `codec_cpp`."""
