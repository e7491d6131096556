"""Printed numbers of the thesis compared with recomputed ones."""
