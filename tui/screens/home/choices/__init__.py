"""What the home screen offers, one a module with its `CHOICE`; each is found by itself."""
