"""What explorers see and answer: the view they are given, what is drawn into it, a destination."""
