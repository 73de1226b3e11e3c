"""The equations of motion of a hypothesis, its ordinary errors, and how it meets a measurement."""
