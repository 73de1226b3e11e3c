"""armodal."""
