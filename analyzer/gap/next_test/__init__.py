"""The further test that would tell most."""
