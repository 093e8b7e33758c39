"""Writers of benchmark files, independent of the package's readers."""
