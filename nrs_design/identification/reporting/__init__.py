"""What is said and drawn of identifications."""
