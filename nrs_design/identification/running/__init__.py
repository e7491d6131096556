"""Whether a run stayed inside what was proved."""
