"""Which effects could explain what a model does not: one search for all of them."""
