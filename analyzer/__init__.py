"""Arrays in, records out: FRFs, modes, arm dynamics, identification, report."""
