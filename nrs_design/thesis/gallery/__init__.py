"""Figures 6.14 to 6.34 of the thesis: simulated counterparts, and what is printed of them."""
