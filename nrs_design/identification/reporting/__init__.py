"""Output of identifications and audits: for JSON, terminals and pages, one file each."""
