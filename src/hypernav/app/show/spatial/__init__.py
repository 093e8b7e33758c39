"""The part of a page that shows a building in three dimensions and can be turned."""
