"""Commands of identification."""
