"""What a component is: its protocol, its optional abilities, how it is found by name."""
