"""Traffic: JAUS messages from hex text, from capture files and from the network."""
