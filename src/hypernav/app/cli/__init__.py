"""The commands of `hypernav`: options, progress on the terminal, exit statuses."""
