"""What is read and written outside this program: files, folders and the network."""
