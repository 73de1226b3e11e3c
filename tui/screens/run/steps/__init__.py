"""The operator's screens, one a module with its `SCREEN`; each is found by itself."""
