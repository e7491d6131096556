"""The velocity-controlled motor from records of commands or a frequency response."""
