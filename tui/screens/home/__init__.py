"""The home screen: sessions to go on with, a new one, the demo, devices."""
