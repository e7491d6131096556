"""Mutation testing of `nrs_design/proof/`: ``python -m tests.mutation exact evidence/flow``.

A mutant is the program with one small error. One that no test of `tests/proof` notices shows a hole
in the tests of what decides, unless it decides the same: then `equivalent.toml` says why.

Tools for this were tried. mutmut leaves decorated functions and class bodies out, and changes every
text; cosmic-ray writes each mutant into the source tree and starts Python anew for it.
"""
