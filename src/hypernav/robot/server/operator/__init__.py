"""For the operator of robots: the page at ``/``, goals for waiting robots, and STOP for all."""
