"""The target `wireshark`: a dissector for Wireshark and tshark, in Lua."""
