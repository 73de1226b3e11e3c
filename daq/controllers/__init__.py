"""Controllers that tell joint angles without a bus, one a module with its `OPTION`."""
