"""What earns a name, what stands beside it, and what the workflow says at the end."""
