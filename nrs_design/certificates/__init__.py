"""Certificates: untrusted searches, the tiny trusted check, and the file format."""
