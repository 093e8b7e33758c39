"""Local perception: detect, segment, refine and project the goal; check its presence."""
