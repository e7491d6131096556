"""What JSON documents say of identifications and audits: one file each."""
