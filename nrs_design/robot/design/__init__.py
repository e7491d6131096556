"""Motion control of the joints: the laws, and their gains."""
