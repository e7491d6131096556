"""Designs for other programs."""
