"""Answers of the commands as they were, so that a change of the code which changes one is seen.

``python -m tests.golden`` asks every command again and writes the answers; the tests compare. They
say what is, not what is right: an answer that ought to change is written anew, and its difference
is read line by line.
"""
