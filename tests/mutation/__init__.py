"""Mutation testing of what decides and encloses: ``python -m tests.mutation proof/exact``.

A mutant is the program with one small error. One that none of its tests notices shows a hole
in the tests of what decides, unless it decides the same: then `equivalent.toml` says why.

By hand, because mutmut leaves most decorated functions out, and our nouns are dataclasses.
"""
