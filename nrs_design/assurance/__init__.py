"""The assurance case of a spec: a folder of evidence, which a later run can check.

`case.py` collects the facts of one spec, the modules beside it say them (register, hazards,
argument, standards, tool, parts list), and `folder.py` writes and checks the files.
"""
