"""Mutation testing of `nrs_design/proof/`: ``python -m tests.mutation exact evidence/graph``.

A mutant is the program with one small error. One that no test of `tests/proof` notices shows a hole
in the tests of what decides, unless it decides the same: then `equivalent.toml` says why.

By hand, because mutmut leaves most decorated functions out, and our nouns are dataclasses.
"""
