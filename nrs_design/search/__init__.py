"""Untrusted searches for evidence: floating point, solvers, heuristics. Nothing here decides."""
