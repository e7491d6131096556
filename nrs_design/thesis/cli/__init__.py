"""Commands about the dissertation."""
