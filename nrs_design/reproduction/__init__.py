"""The dissertation's published numbers beside recomputed ones."""
