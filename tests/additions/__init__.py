"""What is added to a copy of the package, to measure what an addition costs."""
