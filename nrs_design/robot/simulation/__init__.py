"""What the links of a robot do in a run."""
