"""`armodal review`: a session's modes, looked at in the terminal."""
