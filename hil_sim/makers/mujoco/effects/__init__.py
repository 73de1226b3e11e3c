"""Effects of the MuJoCo maker, one a module, found by their module's name."""
