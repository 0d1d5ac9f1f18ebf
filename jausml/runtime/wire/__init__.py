"""Messages on the wire: the base of message classes and the checks of their codecs."""
