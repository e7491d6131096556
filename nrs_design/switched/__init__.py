"""Switched systems with exact matrices."""
