"""The subcommands of `hypernav robot`."""
