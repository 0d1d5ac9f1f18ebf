"""Components: dispatch, life cycle, state machines and the process around them."""
