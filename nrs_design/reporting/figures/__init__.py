"""The figures of the report: one function each, from results to a matplotlib figure."""
