"""Tables of numbers in files of users: columns by quantity and unit."""
