"""Models of personal belongings and household equipment."""
