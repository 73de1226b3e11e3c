"""The screens of `armodal run`, one a file."""
