"""What scripts and notebooks call, handed out by `armodal` itself."""
