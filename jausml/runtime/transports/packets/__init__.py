"""The message layer that all transports share: packets, fragments, acknowledgements."""
