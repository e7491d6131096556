"""Delay of a running loop, from a command and the response."""
