"""Target `bringup`: launch files, parameters and the list of processes of a system."""
