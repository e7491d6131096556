"""The numbers that the thesis prints, beside what this package computes."""
