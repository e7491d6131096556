"""The gate: proof obligations, their rules, the lock, and the formats that CI systems read."""
