"""What users bring from elsewhere: matrices as arrays, text or state spaces, and files of them."""
