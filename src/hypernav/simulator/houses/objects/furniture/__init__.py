"""Models of furniture: seats, beds, tables, cabinets and shelves."""
