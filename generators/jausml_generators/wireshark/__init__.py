"""Target `wireshark`: a dissector for Wireshark and tshark, in Lua."""
