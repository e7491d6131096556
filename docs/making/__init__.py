"""What the documentation makes of the package: pages, figures, and what it refuses."""
