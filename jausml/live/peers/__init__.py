"""Live tools that talk to running JAUS components of any make."""
