"""Plants, textiles and what hangs on walls."""
