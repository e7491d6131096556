"""The parts of the report, from the results to formatted text and drawn figures."""
