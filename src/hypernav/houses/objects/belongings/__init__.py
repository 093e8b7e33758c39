"""What people leave about."""
