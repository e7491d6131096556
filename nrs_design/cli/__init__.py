"""Command line: parse, call the pipeline, print, exit code. No mathematics."""

from nrs_design.cli.app import main

__all__ = ["main"]
