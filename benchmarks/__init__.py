"""Speed against what a user would do without this package, measured side by side in one run."""
