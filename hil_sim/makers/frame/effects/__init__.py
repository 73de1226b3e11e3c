"""Effects of the frame maker, one a module, found by their module's name."""
