"""What decides, and nothing else: the trusted ground floor."""
