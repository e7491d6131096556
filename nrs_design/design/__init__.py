"""How gains are chosen."""
