"""Acquisition: the only user of serial ports and CAN; from bytes to durable hits."""
