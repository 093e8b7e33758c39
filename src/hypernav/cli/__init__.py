"""The commands of `hypernav`: options, progress on the screen, exit statuses."""
