"""Which postures, hits and points tell the most about an arm's joints."""
