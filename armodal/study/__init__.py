"""Studies: sealed cases of the simulator through the gap workflow, marked against their truth."""
