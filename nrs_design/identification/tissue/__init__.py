"""Tissue laws from records of force and deflection."""
