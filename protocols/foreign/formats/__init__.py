"""File formats of other programs, one a module; each is found by itself."""
