"""The operator of robots: the page at ``/``, goals for robots that wait, and STOP for all."""
