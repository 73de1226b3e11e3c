"""What two sides must agree on: wire and file formats, records, error types."""
