"""Certificates as statements and proofs for Coq; the library that they rest on is beside it."""
