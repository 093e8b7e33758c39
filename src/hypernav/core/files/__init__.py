"""Files from outside: how much of them is believed, and how much memory they may take."""
