"""An arm file from a robot description: what is believed, what is guessed, where to measure."""
