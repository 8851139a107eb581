"""The report: figures, tables and words made of the workflow's results, as one HTML page."""
