"""Common to all commands: exit statuses, interruptions, crash reports, checks of outputs."""
