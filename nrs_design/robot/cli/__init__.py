"""Commands of robots."""
