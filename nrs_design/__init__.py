"""Design of compliant controllers for surgical co-worker robots, with proofs."""

__version__ = "0.1.0"
