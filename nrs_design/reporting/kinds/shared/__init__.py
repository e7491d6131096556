"""What the pages of several kinds of evidence say and draw alike."""
