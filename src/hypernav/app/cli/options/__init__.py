"""The options of every command; they import next to nothing, so that help and mistakes are fast."""
