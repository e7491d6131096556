"""Certificates as theorems of Coq, with the library that proves them."""
