"""Runtime that ships with generated code: JUDP transport, JAUS core services, bridge.

Copied into a generated workspace as the package ``jausml_runtime``. It needs the standard
library only; rclpy is imported by the module ``ros`` alone.
"""
