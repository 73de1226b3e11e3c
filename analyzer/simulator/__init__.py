"""A user's own simulator beside a measurement."""
