"""Page and figures of a robot."""
