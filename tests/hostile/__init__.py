"""Whatever a stranger sends: hostile options, goals, outputs and kills, with limits for each."""
