"""What commands show people: the terminal, warnings, tables."""
