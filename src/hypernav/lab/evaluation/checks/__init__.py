"""Checks of what others bring: agents, worlds, models behind a server, data of benchmarks."""
