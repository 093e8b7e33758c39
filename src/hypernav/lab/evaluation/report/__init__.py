"""The report of one or more runs: a page, a CSV file and LaTeX tables."""
