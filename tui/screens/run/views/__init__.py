"""What the screens say, as text made from the state: functions without a screen."""
