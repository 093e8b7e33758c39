"""Drawing of maps, legends and letters."""
