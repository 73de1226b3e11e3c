"""The screens of review, one a module with its `PANE`; each is found by itself."""
