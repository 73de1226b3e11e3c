"""Drivers of front ends, one a module with its `DRIVER`; each is found by its name."""
