"""The delay of a running loop, from what was sent and what came of it."""
