"""`armodal run`: the operator's screens; a view of the acquisition process, never its owner."""
