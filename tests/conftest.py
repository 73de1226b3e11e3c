"""What holds for all tests."""

from hypothesis import settings

# A loaded machine stalls for seconds: how long one example takes says nothing.
settings.register_profile("armodal", deadline=None)
settings.load_profile("armodal")
