"""What the library offers of this wing."""
