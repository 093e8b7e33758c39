"""The folder of a run, written so that crashes and full disks lose no finished episode."""
