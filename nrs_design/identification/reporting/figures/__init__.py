"""Figures of identifications."""
