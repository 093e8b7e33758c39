"""What stands around every command: exit statuses, interruptions, crashes, outputs."""
