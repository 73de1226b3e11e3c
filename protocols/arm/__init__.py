"""The arm description: file and records."""
