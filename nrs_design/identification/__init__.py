"""From measured records to models with intervals that a proof can use."""
