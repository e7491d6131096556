"""Measured records: files with columns that are named by quantity and unit, checked before use."""
