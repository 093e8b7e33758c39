"""Models of objects in kitchens, bathrooms and laundries."""
