"""Local (detect, segment, refine, project) and global (draw, ask, choose, remember)."""
