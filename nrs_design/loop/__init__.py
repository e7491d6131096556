"""The closed loop: blocks wired by name, a calendar of events, and its modes, exactly."""
