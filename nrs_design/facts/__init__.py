"""What is said of a result in a JSON document, and in `to_dict` of the library: one file each."""
