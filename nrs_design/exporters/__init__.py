"""Proved designs for other programs: one validated record, from which every format is made."""
