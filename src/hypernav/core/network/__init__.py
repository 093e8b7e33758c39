"""What model servers and robots have in common: requests over HTTP that end in time."""
