"""A plugin of pytest: tests find a stand-in for geographic_msgs, which no wheel brings."""

from mapping_support import stand_in

stand_in()
