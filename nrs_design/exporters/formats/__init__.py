"""The formats of `nrs-design export`: one module each, of its name, which needs no other file.

Those of wings are in the table of `nrs_design.wings`.

A module has ``FORMAT`` and ``render(export)``, which returns the contents of all files by what
follows the name of the spec, and touches no disk. It may have ``remarks(files)``, which says what
rendered files lack.
"""
