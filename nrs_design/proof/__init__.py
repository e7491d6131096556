"""Trusted ground floor: the exact decisions, and nothing else."""
