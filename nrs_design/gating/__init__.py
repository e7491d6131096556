"""The gate: every spec of a project, its proof obligations, and whether they are met."""
